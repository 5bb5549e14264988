// SPDX-License-Identifier: BSD-3-Clause
// What several evaluations read of folders: images of the truth, the record and poses of a replay.
#pragma once

#include <headway/core/stereo_camera.h>

#include <cstddef>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::eval {

/// Images of one frame of a truth folder written by headway-sim --depth --masks. Both throw
/// InputError if the file is missing or its size differs from the camera's.

/// True depths of the left image: 32-bit float [m], 0 where there is none.
[[nodiscard]] cv::Mat readTrueDepth(const std::filesystem::path& folder, std::size_t frame,
                                    const StereoCamera& camera);

/// Pixels on what may move: 8-bit, non-zero. Widened by the outline that a mask may miss.
[[nodiscard]] cv::Mat readMovingMask(const std::filesystem::path& folder, std::size_t frame,
                                     const StereoCamera& camera);

/// replay.json of a replay's folder. @throws InputError if it is missing or is no JSON object
[[nodiscard]] nlohmann::json replayRecord(const std::filesystem::path& replay);

/// Index of the first frame of a replay, by its record.
[[nodiscard]] std::size_t firstFrame(const nlohmann::json& record);

/// Times of files that differ by less are the same [s].
inline constexpr double kTimeTolerance_s = 1e-3;

/// The pose of a trajectory at a time; null if there is none.
[[nodiscard]] const Pose* poseAt(const std::vector<Stamped<Pose>>& trajectory, Time time);

}  // namespace headway::eval
