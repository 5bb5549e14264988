// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/statistics.h>
#include <headway/stereo/rectification.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace headway::stereo {
namespace {

constexpr std::size_t kEnoughMatches = 200;
constexpr int kYaw = 1;  // of the angles
constexpr int kReweightings = 5;
constexpr double kRowSigma_px = 0.3;      // of a match
constexpr double kIndependent = 0.25;     // ratio of information: the same points recur
constexpr double kPriorSigma = 0.02;      // of each angle [rad]
constexpr double kSignificance = 5.0;     // standard deviations
constexpr double kVisibleRows_px = 0.25;  // rows' differences below do not disturb matching

/// Derivative of a point's row in the right image with respect to pitch, yaw and roll [px/rad].
Eigen::Vector3d rowJacobian(const Eigen::Vector2d& right, const StereoCamera& camera) {
  const double x = (right.x() - camera.cx) / camera.fx;
  const double y = (right.y() - camera.cy) / camera.fy;
  return camera.fy * Eigen::Vector3d(1.0 + y * y, -x * y, -x);
}

/// RMS over the image of the row differences that these angles cause [px].
double rowsRms(const Eigen::Vector3d& angles, const StereoCamera& camera) {
  constexpr int kSteps = 8;
  double sum = 0.0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int k = 0; k <= kSteps; ++k) {
      const Eigen::Vector2d at(i * (camera.width - 1.0) / kSteps,
                               k * (camera.height - 1.0) / kSteps);
      sum += square(rowJacobian(at, camera).dot(angles));
    }
  }
  return std::sqrt(sum) / (kSteps + 1);
}

}  // namespace

void RectificationEstimator::add(const std::vector<RowMatch>& matches) {
  if (matches.empty()) return;
  matches_ += matches.size();
  Eigen::Matrix3d prior = information_;
  prior.diagonal().array() += 1.0 / square(kPriorSigma);
  std::vector<double> rows;
  for (const RowMatch& match : matches) rows.push_back(match.rows);
  Eigen::Vector3d angles(median(rows) / camera_.fy, 0.0, 0.0);
  if (matches_ > kEnoughMatches) angles = prior.ldlt().solve(gradient_);
  Eigen::Matrix3d added;
  Eigen::Vector3d gradient;
  for (int round = 0; round < kReweightings; ++round) {
    added.setZero();
    gradient.setZero();
    for (const RowMatch& match : matches) {
      const Eigen::Vector3d jacobian = rowJacobian(match.right, camera_);
      const double residual = (match.rows - jacobian.dot(angles)) / kRowSigma_px;
      const double weight =
          kIndependent / square(kRowSigma_px) / square(1.0 + square(residual) / 4.0);
      added += weight * jacobian * jacobian.transpose();
      gradient += weight * match.rows * jacobian;
    }
    angles = (prior + added).ldlt().solve(gradient_ + gradient);
  }
  information_ += added;
  gradient_ += gradient;
}

std::optional<RectificationError> RectificationEstimator::error() const {
  if (matches_ < kEnoughMatches) return std::nullopt;
  Eigen::Matrix3d information = information_;
  information.diagonal().array() += 1.0 / square(kPriorSigma);
  const Eigen::Matrix3d covariance = information.inverse();
  RectificationError error;
  error.angles = covariance * gradient_;
  error.sigmas = covariance.diagonal().cwiseSqrt();
  error.offset_px = camera_.fy * error.angles.x();
  error.offset_sigma_px = camera_.fy * error.sigmas.x();
  Eigen::Vector3d without_yaw = error.angles;
  without_yaw[kYaw] = 0.0;
  error.rows_rms_px = rowsRms(without_yaw, camera_);
  return error;
}

Eigen::Vector3d significantAngles(const RectificationError& error, const StereoCamera& camera) {
  Eigen::Vector3d angles = error.angles;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d alone = Eigen::Vector3d::Zero();
    alone[axis] = error.angles[axis];
    const bool is_significant = std::abs(error.angles[axis]) > kSignificance * error.sigmas[axis];
    if (axis == kYaw || !is_significant || rowsRms(alone, camera) < kVisibleRows_px)
      angles[axis] = 0.0;
  }
  return angles;
}

std::string describe(const RectificationError& error, const StereoCamera& camera) {
  constexpr std::array<const char*, 3> kAxes = {"pitch", "yaw", "roll"};
  constexpr double kDegrees = 180.0 / M_PI;
  const Eigen::Vector3d angles = kDegrees * error.angles, sigmas = kDegrees * error.sigmas;
  const Eigen::Vector3d significant = significantAngles(error, camera);
  std::string axes;
  for (int axis = 0; axis < 3; ++axis) {
    if (significant[axis] == 0.0) continue;
    axes += (axes.empty() ? "" : ", ") + std::string(kAxes[static_cast<std::size_t>(axis)]);
  }
  std::array<char, 300> text{};
  std::snprintf(text.data(), text.size(),
                "rectification off by %.2f +- %.2f px (rows %.2f px RMS; pitch %.3f +- %.3f, roll "
                "%.3f +- %.3f deg): ",
                error.offset_px, error.offset_sigma_px, error.rows_rms_px, angles.x(), sigmas.x(),
                angles.z(), sigmas.z());
  const std::string advice = " of the right camera; calibrate the cameras";
  return text.data() + (axes.empty() ? std::string("not significant") : axes + advice);
}

}  // namespace headway::stereo
