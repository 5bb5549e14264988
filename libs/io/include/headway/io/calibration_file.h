#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/io/rawlog_sink.h>

#include <string>
#include <vector>

namespace headway::io {

/// Writes a rectified pair as `calibration.yaml` (doc/formats.md) without loss of precision.
///
/// @throws InputError if the file cannot be written
void writeCalibration(const std::string& path, const StereoCamera& camera);

/// Reads a pair, rectified or not.
///
///     image_size: [1226, 370]
///     left:  [707.0912, 707.0912, 601.8873, 183.1104]   # fx fy cx cy [k1 k2 p1 p2 [k3]]
///     right: [707.0912, 707.0912, 601.8873, 183.1104]   # default: as `left`
///     baseline_m: 0.5371506           # or T_left_right: 3x4 or 4x4, row-major
///     T_robot_cam: [...]              # left camera on the robot; default: robot axes at the
///     camera
///
/// @param also_known  further keys that are allowed
/// @throws InputError naming file and key that is missing, unknown or invalid
[[nodiscard]] RawStereoCamera readRawCalibration(const std::string& path,
                                                 const std::vector<std::string>& also_known = {});

/// Reads a rectified pair, as written by writeCalibration().
///
/// @throws InputError as above, and if the pair is not rectified
[[nodiscard]] StereoCamera readCalibration(const std::string& path);

}  // namespace headway::io
