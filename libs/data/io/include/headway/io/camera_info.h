// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/rawlog_sink.h>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace headway::io {

/// Calibration of one camera as ROS describes it (sensor_msgs/CameraInfo, camera_info files).
struct CameraInfo {
  int width = 0;                 ///< [px]
  int height = 0;                ///< [px]
  std::string distortion_model;  ///< plumb_bob, rational_polynomial, equidistant, or empty
  std::vector<double> D;
  std::array<double, 9> K{};   ///< of the raw image, row-major
  std::array<double, 9> R{};   ///< rotation from the raw to the rectified camera; zeros: none
  std::array<double, 12> P{};  ///< of the rectified image
};

/// Images that a calibration is to describe.
enum class ImageKind { kRaw, kRectified };

/// The lens of raw images (K and D) or of rectified ones (P).
///
/// @throws InputError if the distortion model is not known, or D has too many coefficients for it
[[nodiscard]] RawCamera lensFrom(const CameraInfo& info, ImageKind kind);

/// The right camera in the left one, from R and P; nullopt if P states no baseline.
///
/// @throws InputError if R is not a rotation
[[nodiscard]] std::optional<Pose> rightInLeft(const CameraInfo& left, const CameraInfo& right,
                                              ImageKind kind);

/// What is impossible about a lens, with a hint; empty if nothing is.
[[nodiscard]] std::string lensFault(const RawCamera& lens);

/// What is impossible about the distance of two cameras [m], with a hint; empty if nothing is.
[[nodiscard]] std::string baselineFault(double baseline_m);

}  // namespace headway::io
