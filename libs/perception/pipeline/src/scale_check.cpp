// SPDX-License-Identifier: BSD-3-Clause
#include "scale_check.h"

#include <headway/core/statistics.h>
#include <headway/core/text.h>

#include <cmath>
#include <utility>

namespace headway::pipeline {
namespace {

constexpr double kPieceM = 2.0;
constexpr double kStraight = 0.7;         // least length of a piece's chord to its path
constexpr std::size_t kMinPieces = 5;     // that are compared
constexpr std::size_t kMaxPieces = 200;   // that are remembered
constexpr double kSaidDifference = 0.01;  // of the scales
constexpr double kSure = 3.0;             // standard deviations
constexpr double kDeviation = 1.4826;     // standard by median absolute deviation, of a Gaussian
constexpr double kMedian = 1.2533;        // standard error of a median to that of a mean
constexpr double kOtherUnit = 30.0;       // camera to odometry: the unit is wrong
constexpr double kOtherScale = 3.0;       // and its inverse: said at once

}  // namespace

Findings ScaleCheck::add(const std::optional<Pose>& by_camera,
                         const std::optional<Pose>& by_odometry, std::size_t frame) {
  if (!by_camera || !by_odometry) {
    piece_ = {};
    return {};
  }
  piece_.by_camera = piece_.by_camera * *by_camera;
  piece_.by_odometry = piece_.by_odometry * *by_odometry;
  piece_.path_m += by_odometry->translation().norm();
  if (piece_.path_m < kPieceM) return {};
  Findings findings;
  const double by_wheels = piece_.by_odometry.translation().norm();
  if (by_wheels > kStraight * piece_.path_m) {
    if (auto finding = checkUnit(frame)) findings.push_back(std::move(*finding));
    ratios_.push_back(piece_.by_camera.translation().norm() / by_wheels);
    if (ratios_.size() > kMaxPieces) ratios_.pop_front();
  }
  piece_ = {};
  const auto found = ratio();
  if (!found || std::abs(found->value - 1.0) - kSure * found->sigma < kSaidDifference) {
    return findings;
  }
  findings.push_back(
      {"odometry_scale", frame,
       formatted("the camera moves %.3f +- %.3f times as far as the wheels say: check the "
                 "calibration's baseline and focal length, and the size of the wheels; the map has "
                 "the camera's scale",
                 found->value, found->sigma)});
  return findings;
}

std::optional<Finding> ScaleCheck::checkUnit(std::size_t frame) {
  if (std::exchange(is_unit_checked_, true)) return std::nullopt;
  const double camera_m = piece_.by_camera.translation().norm();
  const double odometry_m = piece_.by_odometry.translation().norm();
  const double ratio = camera_m / odometry_m;
  const std::string compared =
      formatted("the camera moved %.3g m where odometry measured %.3g m: ", camera_m, odometry_m);
  const bool is_depth = camera_.isDepthCamera();
  if (ratio > kOtherUnit) {
    const std::string text =
        is_depth ? "depth camera: " + compared +
                       formatted(
                           "depths are too great, as if in another unit (rangeUnits, "
                           "depth_unit_m); multiply it by %.3g",
                           1.0 / ratio)
                 : "stereo calibration: " + compared +
                       formatted(
                           "the baseline of %.6g m is too long, as if in another unit; write "
                           "%.3g m",
                           camera_.baseline_m, camera_.baseline_m / ratio);
    return Finding{"distance_unit", frame, text, Severity::kFatal};
  }
  if (ratio <= kOtherScale && ratio >= 1.0 / kOtherScale) return std::nullopt;
  const std::string cause = is_depth ? "check the depths' unit"
                                     : formatted("check the baseline (%.6g m)", camera_.baseline_m);
  return Finding{"odometry_scale", frame,
                 compared + cause + ", and odometry's unit and wheel slip"};
}

std::optional<ScaleCheck::Ratio> ScaleCheck::ratio() const {
  if (ratios_.size() < kMinPieces) return std::nullopt;
  Ratio result;
  result.value = median({ratios_.begin(), ratios_.end()});
  std::vector<double> deviations;
  for (const double one : ratios_) deviations.push_back(std::abs(one - result.value));
  result.sigma =
      kMedian * kDeviation * median(deviations) / std::sqrt(static_cast<double>(ratios_.size()));
  return result;
}

}  // namespace headway::pipeline
