#pragma once

#include <cstdint>
#include <filesystem>
#include <map>

namespace headway::replay {

/// Replaces the score of every row of a file of KITTI tracking results by that of its track.
///
/// KITTI's results are judged by whole tracks, so a row's score is the track's as known at the end;
/// while the replay runs, the file holds what was known at each frame.
///
/// @param scores  track id -> score; rows of other tracks stay as they are
/// @throws InputError naming the file if it cannot be read or written
void rescoreKittiResults(const std::filesystem::path& file,
                         const std::map<std::int64_t, double>& scores);

}  // namespace headway::replay
