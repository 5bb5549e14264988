// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/rawlog_sink.h>

#include <string>

namespace headway::io {

/// A calibration of a depth camera and of the folders with its images (doc/formats.md).
struct DepthCalibrationFile {
  RawDepthCamera camera;
  double frame_rate = 0.0;  ///< [Hz]; 0: not stated
  std::string times;        ///< name of a file with times; empty: not stated
};

/// Reads headway's format:
///
///     image_size: [640, 480]
///     left:  [525.0, 525.0, 319.5, 239.5]   # fx fy cx cy [k1 k2 p1 p2 [k3 [k4 k5 k6]]]
///     depth: [...], depth_size: [...]       # default: as left, registered
///     T_left_depth: [...]                   # depth's optical frame in left's; default: the same
///     depth_unit_m: 0.001, depth_range_m: 8.0, range_is_depth: true, T_robot_cam: [...]
///
/// @throws InputError naming file and key that is missing, unknown or impossible
[[nodiscard]] DepthCalibrationFile readDepthCalibration(const std::string& path);

}  // namespace headway::io
