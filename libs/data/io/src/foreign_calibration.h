// SPDX-License-Identifier: BSD-3-Clause
// Calibrations that other programs write: ROS, Kalibr, ORB-SLAM, OpenCV, MRPT.
#pragma once

#include <headway/io/calibration_file.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "yaml_file.h"

namespace headway::io {

// Readers of calibrations that other programs write. Each returns nullopt for files of another
// format, and throws InputError naming file and key for those of its own that are not usable.

/// `camera_info` of two cameras, as camera_calibration writes them, in two files.
[[nodiscard]] std::optional<StereoCalibrationFile> readCameraInfoPair(
    const std::vector<YamlFile>& files);
/// Kalibr's `camchain.yaml`: cam0 is the left camera, cam1 the right one.
[[nodiscard]] std::optional<StereoCalibrationFile> readKalibr(const std::vector<YamlFile>& files);
/// Settings of ORB-SLAM2 and ORB-SLAM3 for stereo cameras.
[[nodiscard]] std::optional<StereoCalibrationFile> readOrbSlam(const std::vector<YamlFile>& files);
/// What OpenCV's samples of stereo calibration write, in one file or two.
[[nodiscard]] std::optional<StereoCalibrationFile> readOpenCv(const std::vector<YamlFile>& files,
                                                              std::array<int, 2> image_size);
/// MRPT's `.ini` of a TStereoCamera: sections X_LEFT, X_RIGHT, X_LEFT2RIGHT_POSE.
[[nodiscard]] std::optional<StereoCalibrationFile> readMrptIni(const std::string& path);

/// @throws InputError naming file and key if the lens is impossible
void requireLens(const RawCamera& lens, const YamlFile& file, const std::string& key);
/// @throws InputError naming file and key if the cameras are too far apart
void requireBaseline(const Pose& T_left_right, const YamlFile& file, const std::string& key);

}  // namespace headway::io
