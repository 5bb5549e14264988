// SPDX-License-Identifier: BSD-3-Clause
// Images of a truth folder.
#pragma once

#include <headway/core/stereo_camera.h>

#include <cstddef>
#include <filesystem>
#include <opencv2/core/mat.hpp>

namespace headway::eval {

/// Images of one frame of a truth folder written by headway-sim --depth --masks. Both throw
/// InputError if the file is missing or its size differs from the camera's.

/// True depths of the left image: 32-bit float [m], 0 where there is none.
[[nodiscard]] cv::Mat readTrueDepth(const std::filesystem::path& folder, std::size_t frame,
                                    const StereoCamera& camera);

/// Pixels on what may move: 8-bit, non-zero. Widened by the outline that a mask may miss.
[[nodiscard]] cv::Mat readMovingMask(const std::filesystem::path& folder, std::size_t frame,
                                     const StereoCamera& camera);

}  // namespace headway::eval
