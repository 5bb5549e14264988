// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/formatted.h>
#include <headway/core/statistics.h>
#include <headway/pipeline/scale_check.h>

#include <cmath>
#include <vector>

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

}  // namespace

void ScaleCheck::add(const Pose& by_camera, const std::optional<Pose>& by_odometry,
                     std::size_t frame, Warnings& warnings) {
  if (!by_odometry) return interrupt();
  piece_.by_camera = piece_.by_camera * by_camera;
  piece_.by_odometry = piece_.by_odometry * *by_odometry;
  piece_.path_m += by_odometry->translation().norm();
  if (piece_.path_m < kPieceM) return;
  const double by_wheels = piece_.by_odometry.translation().norm();
  if (by_wheels > kStraight * piece_.path_m) {
    ratios_.push_back(piece_.by_camera.translation().norm() / by_wheels);
    if (ratios_.size() > kMaxPieces) ratios_.pop_front();
  }
  interrupt();
  const auto found = ratio();
  if (!found || std::abs(found->value - 1.0) - kSure * found->sigma < kSaidDifference) return;
  addWarning("odometry_scale", frame,
             formatted("the camera moves %.3f +- %.3f times as far as the wheels say: check the "
                       "calibration's baseline and focal length, and the size of the wheels; the "
                       "map has the camera's scale",
                       found->value, found->sigma),
             warnings);
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
