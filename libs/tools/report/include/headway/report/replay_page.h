// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/report/page_images.h>
#include <headway/report/replay_frames.h>

#include <filesystem>
#include <string>
#include <vector>

namespace headway::report {

/// What the page of a replay shows beside the files in the replay's folder.
struct ReplayPageOptions {
  std::filesystem::path truth;   ///< folder with trajectory.tum and objects.csv; empty: no truth
  std::filesystem::path output;  ///< empty: replay.html in the replay's folder
  std::string title;             ///< empty: the name of the recording, or of the folder
  std::vector<Stamped<Pose>> keyframes;  ///< robot in map
  JpegByFrame images;                    ///< of the left camera
};

/// Writes a finished replay as one self-contained HTML page with a 3D view and a timeline.
///
/// Shows the map (`map_dense.ply`, `map_points.ply`, `map_grid.yaml`), the robot's path and images,
/// boxes, their trails and predictions, and the truth. Of long runs at most 2000 frames are shown,
/// of large maps at most 600,000 points. Missing files are left out. The page loads nothing from
/// elsewhere, and its Content-Security-Policy allows no scripts but its own. The same folder and
/// options give the same bytes.
///
///     report::writeReplayPage(outdir, {}, note);
///
/// @param note  receives what is missing
/// @return the page's path
/// @throws InputError if there is no trajectory, a file is malformed, or the page cannot be written
std::filesystem::path writeReplayPage(const std::filesystem::path& folder,
                                      const ReplayPageOptions& options, const Note& note);

}  // namespace headway::report
