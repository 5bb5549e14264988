#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/io/rawlog_sink.h>

#include <string>
#include <vector>

namespace headway::io {

/// Writes a rectified pair as `calibration.yaml` (doc/formats.md), every digit kept.
///
/// @throws InputError if the file cannot be written
void writeCalibration(const std::string& path, const StereoCamera& camera);

/// Reads a pair, rectified or not.
///
///     image_size: [1226, 370]
///     left:  [707.0912, 707.0912, 601.8873, 183.1104]   # fx fy cx cy [k1 k2 p1 p2 [k3]]
///     right: [707.0912, 707.0912, 601.8873, 183.1104]   # as `left` where it is missing
///     baseline_m: 0.5371506           # or T_left_right: 3x4 or 4x4, row by row
///     T_robot_cam: [...]              # left camera on the robot; default: axes turned, no offset
///
/// @param also_known  further keys that the file may have
/// @throws InputError naming file and key of what is missing, unknown or wrong
[[nodiscard]] RawStereoCamera readRawCalibration(const std::string& path,
                                                 const std::vector<std::string>& also_known = {});

/// Reads a pair that must be rectified: what writeCalibration() wrote.
///
/// @throws InputError as above, and if the pair is not rectified
[[nodiscard]] StereoCamera readCalibration(const std::string& path);

}  // namespace headway::io
