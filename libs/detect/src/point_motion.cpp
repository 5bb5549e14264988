#include "point_motion.h"

#include <headway/stereo/stereo_residual.h>

#include <Eigen/Cholesky>
#include <algorithm>

namespace headway::detect {
namespace {

constexpr double kLeastDepth = 0.5;  // [m]

// Measured less predicted, and d predicted / d point in the world; both in sigmas.
struct Residual {
  Eigen::Vector3d error;
  Eigen::Matrix3d jacobian;
};

class Residuals {
 public:
  Residuals(const CameraPath& path, const StereoCamera& camera, const SightingNoise& noise)
      : path_(path),
        camera_(camera),
        weights_(1.0 / noise.u, 1.0 / noise.v, 1.0 / noise.disparity) {}

  [[nodiscard]] std::optional<Residual> of(const Sighting& sighting,
                                           const Eigen::Vector3d& point) const {
    const Pose& T_cam_world = path_.T_cam_world(sighting.frame);
    const Eigen::Vector3d p = T_cam_world * point;
    if (p.z() < kLeastDepth) return std::nullopt;
    Residual residual;
    residual.error =
        -stereo::stereoResidual(p, sighting.uvd, weights_, camera_, &residual.jacobian);
    residual.jacobian *= T_cam_world.linear();
    return residual;
  }

  [[nodiscard]] double disparityWeight() const { return weights_.z(); }

 private:
  const CameraPath& path_;
  const StereoCamera& camera_;
  Eigen::Vector3d weights_;
};

bool fitStill(const std::vector<Sighting>& sightings, const Residuals& residuals,
              PointMotion& motion) {
  for (int iteration = 0; iteration < 3; ++iteration) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    Eigen::Vector3d coupling = Eigen::Vector3d::Zero();  // of the point and a disparity offset
    motion.still_error = 0.0;
    motion.offset_push = 0.0;
    for (const auto& sighting : sightings) {
      const auto residual = residuals.of(sighting, motion.still_point);
      if (!residual) return false;
      A += residual->jacobian.transpose() * residual->jacobian;
      b += residual->jacobian.transpose() * residual->error;
      motion.still_error += residual->error.squaredNorm();
      coupling += residuals.disparityWeight() * residual->jacobian.row(2).transpose();
      motion.offset_push += residuals.disparityWeight() * residual->error.z();
    }
    const Eigen::LDLT<Eigen::Matrix3d> solver(A);
    if (iteration < 2) {
      motion.still_point += solver.solve(b);
    } else {
      // The point marginalised out (Schur complement).
      const double weight = residuals.disparityWeight();
      motion.offset_information = static_cast<double>(sightings.size()) * weight * weight -
                                  coupling.dot(solver.solve(coupling));
      motion.offset_push -= coupling.dot(solver.solve(b));
    }
  }
  return motion.still_point.allFinite();
}

bool fitMoving(const std::vector<Sighting>& sightings, const CameraPath& path,
               const Residuals& residuals, double speed_prior, PointMotion& motion) {
  const Time now = path.timeOf(path.newest());
  const double prior = 1.0 / (speed_prior * speed_prior);
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix<double, 6, 6> A = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> b = Eigen::Matrix<double, 6, 1>::Zero();
    A.bottomRightCorner<3, 3>().diagonal().setConstant(prior);
    b.tail<3>() = -prior * motion.velocity;
    motion.moving_error = prior * motion.velocity.squaredNorm();
    for (const auto& sighting : sightings) {
      const double t = path.timeOf(sighting.frame) - now;
      const auto residual = residuals.of(sighting, motion.point + t * motion.velocity);
      if (!residual) return false;
      const Eigen::Matrix3d JJ = residual->jacobian.transpose() * residual->jacobian;
      const Eigen::Vector3d Je = residual->jacobian.transpose() * residual->error;
      A.topLeftCorner<3, 3>() += JJ;
      A.topRightCorner<3, 3>() += t * JJ;
      A.bottomLeftCorner<3, 3>() += t * JJ;
      A.bottomRightCorner<3, 3>() += t * t * JJ;
      b.head<3>() += Je;
      b.tail<3>() += t * Je;
      motion.moving_error += residual->error.squaredNorm();
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

}  // namespace

std::vector<Sighting> since(int frame, const std::vector<Sighting>& sightings) {
  return {std::find_if(sightings.begin(), sightings.end(),
                       [&](const Sighting& sighting) { return sighting.frame >= frame; }),
          sightings.end()};
}

std::optional<PointMotion> fitMotion(const std::vector<Sighting>& sightings, const CameraPath& path,
                                     const StereoCamera& camera, const SightingNoise& noise,
                                     double speed_prior) {
  if (sightings.size() < 2) return std::nullopt;
  const auto newest = triangulate(sightings.back().uvd, camera);
  if (!newest) return std::nullopt;
  PointMotion motion;
  motion.sightings = static_cast<int>(sightings.size());
  motion.still_point = path.T_cam_world(sightings.back().frame).inverse() * *newest;
  motion.point = motion.still_point;
  const Residuals residuals(path, camera, noise);
  if (!fitStill(sightings, residuals, motion)) return std::nullopt;
  if (!fitMoving(sightings, path, residuals, speed_prior, motion)) return std::nullopt;
  return motion;
}

}  // namespace headway::detect
