// SPDX-License-Identifier: BSD-3-Clause
// Motion of a point: its observations in the last frames, the fit as static and as moving, and its
// class.
#include "point_motion.h"

#include <headway/core/statistics.h>
#include <headway/stereo/rectification.h>
#include <headway/stereo/stereo_residual.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

constexpr double kMinDepth = 0.5;  // [m]

// Measured less predicted, and d predicted / d point in the world; both in sigmas.
struct Residual {
  Eigen::Vector3d error;
  Eigen::Matrix3d jacobian;
};

class Residuals {
 public:
  Residuals(const CameraPath& path, const StereoCamera& camera, const ObservationNoise& noise)
      : path_(path), camera_(camera), noise_(noise) {}

  /// @param sigma_m  of the place where the point is expected at that time
  [[nodiscard]] std::optional<Residual> of(const Observation& observation,
                                           const Eigen::Vector3d& point,
                                           double sigma_m = 0.0) const {
    const Pose& T_cam_world = path_.T_cam_world(observation.frame);
    const Eigen::Vector3d p = T_cam_world * point;
    if (p.z() < kMinDepth) return std::nullopt;
    const double px = camera_.fx * sigma_m / p.z();
    const Eigen::Vector3d weights(
        1.0 / std::hypot(noise_.u, px), 1.0 / std::hypot(noise_.v, px),
        1.0 / std::hypot(noise_.disparity, px * camera_.baseline_m / p.z()));
    Residual residual;
    residual.error =
        -stereo::stereoResidual(p, observation.uvd, weights, camera_, &residual.jacobian);
    residual.jacobian *= T_cam_world.linear();
    return residual;
  }

  [[nodiscard]] double disparityWeight() const { return 1.0 / noise_.disparity; }

 private:
  const CameraPath& path_;
  const StereoCamera& camera_;
  const ObservationNoise& noise_;
};

bool fitStatic(const std::vector<Observation>& observations, const Residuals& residuals,
               PointMotion& motion) {
  for (int iteration = 0; iteration < 3; ++iteration) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    Eigen::Vector3d coupling = Eigen::Vector3d::Zero();  // of the point and a disparity offset
    motion.static_error = 0.0;
    motion.offset_gradient = 0.0;
    for (const auto& observation : observations) {
      const auto residual = residuals.of(observation, motion.static_point);
      if (!residual) return false;
      A += residual->jacobian.transpose() * residual->jacobian;
      b += residual->jacobian.transpose() * residual->error;
      motion.static_error += residual->error.squaredNorm();
      coupling += residuals.disparityWeight() * residual->jacobian.row(2).transpose();
      motion.offset_gradient += residuals.disparityWeight() * residual->error.z();
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(A);
    if (iteration < 2) {
      motion.static_point += solver.solve(b);
    } else {
      // The point marginalised out (Schur complement).
      const double weight = residuals.disparityWeight();
      motion.offset_information = static_cast<double>(observations.size()) * weight * weight -
                                  coupling.dot(solver.solve(coupling));
      motion.offset_gradient -= coupling.dot(solver.solve(b));
    }
  }
  return motion.static_point.allFinite();
}

/// A point that moves at constant velocity, but for an acceleration.
///
/// @param acceleration_mps2  standard deviation; what it adds to the noise of older observations is
///                           taken for independent
bool fitMoving(const std::vector<Observation>& observations, const CameraPath& path,
               const Residuals& residuals, double speed_prior, double acceleration_mps2,
               PointMotion& motion) {
  const Time now = path.timeOf(path.newest());
  const double prior = 1.0 / (speed_prior * speed_prior);
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    A.bottomRightCorner<3, 3>().diagonal().setConstant(prior);
    b.tail<3>() = -prior * motion.velocity;
    motion.accelerated_error = prior * motion.velocity.squaredNorm();
    for (const auto& observation : observations) {
      const double t = path.timeOf(observation.frame) - now;
      const auto residual = residuals.of(observation, motion.point + t * motion.velocity,
                                         0.5 * acceleration_mps2 * t * t);
      if (!residual) return false;
      const Eigen::Matrix3d JJ = residual->jacobian.transpose() * residual->jacobian;
      const Eigen::Vector3d Je = residual->jacobian.transpose() * residual->error;
      A.topLeftCorner<3, 3>() += JJ;
      A.topRightCorner<3, 3>() += t * JJ;
      A.bottomLeftCorner<3, 3>() += t * JJ;
      A.bottomRightCorner<3, 3>() += t * t * JJ;
      b.head<3>() += Je;
      b.tail<3>() += t * Je;
      motion.accelerated_error += residual->error.squaredNorm();
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(A);
    if (iteration < 3) {
      const Eigen::Matrix<double, 6, 1> step = solver.solve(b);
      motion.point += step.head<3>();
      motion.velocity += step.tail<3>();
    } else {
      motion.velocity_covariance =
          solver.solve(Eigen::Matrix<double, 6, 6>::Identity()).bottomRightCorner<3, 3>();
    }
  }
  return motion.point.allFinite() && motion.velocity.allFinite();
}

constexpr double kBadFit = 6.0;  // squared error to a degree of freedom

}  // namespace

std::vector<Observation> since(int frame, const std::vector<Observation>& observations) {
  return {std::find_if(observations.begin(), observations.end(),
                       [&](const Observation& observation) { return observation.frame >= frame; }),
          observations.end()};
}

std::optional<PointMotion> fitMotion(const std::vector<Observation>& observations,
                                     const CameraPath& path, const StereoCamera& camera,
                                     const ObservationNoise& noise, double speed_prior) {
  if (observations.size() < 2) return std::nullopt;
  const auto newest = triangulate(observations.back().uvd, camera);
  if (!newest) return std::nullopt;
  PointMotion motion;
  motion.observations = static_cast<int>(observations.size());
  motion.static_point = path.T_cam_world(observations.back().frame).inverse() * *newest;
  motion.point = motion.static_point;
  const Residuals residuals(path, camera, noise);
  if (!fitStatic(observations, residuals, motion)) return std::nullopt;
  if (!fitMoving(observations, path, residuals, speed_prior, 0.0, motion)) return std::nullopt;
  motion.moving_error = motion.accelerated_error;
  motion.steady_velocity = motion.velocity;
  motion.steady_covariance = motion.velocity_covariance;
  const bool stands =
      motion.staticFit() < kGoodFit && motion.static_error - motion.moving_error < chiSquare99(3);
  if (stands) return motion;
  if (!fitMoving(observations, path, residuals, speed_prior, noise.acceleration_mps2, motion)) {
    return std::nullopt;
  }
  return motion;
}

PointClass classifyPoint(const PointTrack& point, const Eigen::Vector3d& up,
                         const PointClassParams& params) {
  if (!point.motion || point.motion->observations < params.min_observations) {
    return PointClass::kUnknown;
  }
  const PointMotion& motion = *point.motion;
  const double static_fit = motion.staticFit();
  const double moving_fit = motion.movingFit();
  if (moving_fit > kBadFit && static_fit > kBadFit) return PointClass::kMismatch;
  const Eigen::Vector3d steady = overGround(motion.steady_velocity, up);
  const Eigen::Vector3d velocity = overGround(motion.velocity, up);
  const double speed = velocity.norm();
  const bool significant =
      motion.static_error - motion.moving_error > params.significance &&
      steady.norm() > params.speed_sigmas * sigmaAlong(steady, motion.steady_covariance) &&
      square(speed / sigmaAlong(velocity, motion.velocity_covariance)) > chiSquare99(1);
  const bool possible =
      speed > params.min_speed && speed < params.max_speed && motion.velocity.norm() < 2.0 * speed;
  if (significant && possible && moving_fit < kGoodFit) return PointClass::kMoving;
  return static_fit < kGoodFit ? PointClass::kStatic : PointClass::kUnknown;
}

bool TurnChange::advance(const stereo::FrameContext& context) {
  before_ = now_;
  now_ = {context.rightTurn(), context.disparityOffset()};
  return now_.angles != before_.angles;
}

void TurnChange::apply(std::vector<Observation>& observations) const {
  for (Observation& one : observations) {
    const double measured = one.uvd.z() + before_.offset_px;
    one.uvd.z() =
        stereo::turnedDisparity(one.uvd.head<2>(), measured, before_.angles, now_.angles, camera_) -
        now_.offset_px;
  }
  const auto is_too_far = [](const Observation& one) { return one.uvd.z() < kMinDisparity; };
  observations.erase(std::remove_if(observations.begin(), observations.end(), is_too_far),
                     observations.end());
}

}  // namespace headway::detect
