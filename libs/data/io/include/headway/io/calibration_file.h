// SPDX-License-Identifier: BSD-3-Clause
// Calibrations in headway's own format, and telling apart those of other programs.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/io/rawlog_sink.h>

#include <array>
#include <string>
#include <vector>

namespace headway::io {

/// Writes a rectified pair, or a depth camera, as `calibration.yaml` (doc/formats.md) without loss
/// of precision.
///
/// @throws InputError if the file cannot be written
void writeCalibration(const std::string& path, const StereoCamera& camera);

/// Reads a pair, rectified or not, in headway's own format.
///
///     image_size: [1226, 370]
///     left:  [707.0912, 707.0912, 601.8873, 183.1104]   # fx fy cx cy [k1 k2 p1 p2 [k3 [k4 k5
///     k6]]] right: [707.0912, 707.0912, 601.8873, 183.1104]   # default: as `left` baseline_m:
///     0.5371506           # or T_left_right: 3x4 or 4x4, row-major lens_model: fisheye # k1 k2 k3
///     k4 after cy; default: pinhole T_robot_cam: [...]              # left camera on the robot;
///     default: robot axes at the camera
///
/// @param also_known  further keys that are allowed
/// @throws InputError naming file and key that is missing, unknown or invalid
[[nodiscard]] RawStereoCamera readRawCalibration(const std::string& path,
                                                 const std::vector<std::string>& also_known = {});

/// A pair read by readStereoCalibration().
struct StereoCalibrationFile {
  RawStereoCamera camera;
  std::string format;       ///< such as "Kalibr camchain"
  bool is_mounted = false;  ///< whether the file states T_robot_left
  double frame_rate = 0.0;  ///< [Hz]; 0: not stated
  std::string times;        ///< name of a file with times; empty: not stated
};

/// Reads a pair in any of the formats of doc/formats.md, told apart by their content: headway's,
/// MRPT's stereo .ini, ROS camera_info, Kalibr's camchain, ORB-SLAM's, OpenCV's.
///
/// @param paths       a file, or two separated by a comma: left and right camera_info, or OpenCV's
///                    intrinsics and extrinsics
/// @param image_size  width and height of the images [px], for files without; 0: unknown
/// @throws InputError naming file and key that is missing, unknown or impossible, with a hint
[[nodiscard]] StereoCalibrationFile readStereoCalibration(const std::string& paths,
                                                          std::array<int, 2> image_size = {0, 0});

/// Reads a rectified pair or a depth camera, as written by writeCalibration().
///
/// @throws InputError as above, and if the pair is not rectified
[[nodiscard]] StereoCamera readCalibration(const std::string& path);

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
