#include "camera_path.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

constexpr double kPriorTranslation = 0.004;  // of the motion given, frame to frame [m]
constexpr double kPriorRotation = 0.0035;    // [rad]
constexpr double kGuessed = 10.0;            // times worse is a motion that was not given
constexpr double kMostAcceleration = 25.0;   // of a vehicle [m/s^2]
constexpr double kMostTurn = 10.0;           // [rad/s^2]
constexpr double kAgrees = 3.0;              // error of a point that agrees, in sigmas
constexpr int kIterations = 6;

struct Normal {
  Matrix6 A = Matrix6::Zero();
  Vector6 b = Vector6::Zero();
  int agreeing = 0;
};

// Derivative of (u, v, disparity) with respect to the point in the camera frame.
Eigen::Matrix3d projectionJacobian(const Eigen::Vector3d& p, const StereoCamera& camera) {
  const double z2 = p.z() * p.z();
  Eigen::Matrix3d J;
  J << camera.fx / p.z(), 0.0, -camera.fx * p.x() / z2,  //
      0.0, camera.fy / p.z(), -camera.fy * p.y() / z2,   //
      0.0, 0.0, -camera.fx * camera.baseline_m / z2;
  return J;
}

// The camera is moved on the left: p' = p + rotation x p + translation.
void add(const StillSighting& sighting, const Pose& T_cam_world, const StereoCamera& camera,
         double sigma_px, Normal& normal) {
  const Eigen::Vector3d p = T_cam_world * sighting.point;
  const auto predicted = project(p, camera);
  if (!predicted || p.z() < 0.5) return;
  const Eigen::Vector3d error = (sighting.uvd - *predicted) / sigma_px;
  const double squared = error.squaredNorm();
  if (squared < kAgrees * kAgrees) ++normal.agreeing;
  const double weight = 1.0 / (1.0 + squared / 4.0);
  Eigen::Matrix<double, 3, 6> J;
  J << Eigen::Matrix3d::Identity(), -crossMatrix(p);
  J = projectionJacobian(p, camera) * J / sigma_px;
  normal.A += weight * J.transpose() * J;
  normal.b += weight * J.transpose() * error;
}

Matrix6 priorInformation(double worse) {
  Vector6 sigmas;
  sigmas << Eigen::Vector3d::Constant(kPriorTranslation), Eigen::Vector3d::Constant(kPriorRotation);
  return (worse * sigmas).cwiseAbs2().cwiseInverse().asDiagonal();
}

bool isJump(const Pose& motion, const Pose& expected, double seconds) {
  const Pose off = motion * expected.inverse();
  const double squared = seconds * seconds;
  return (motion.translation() - expected.translation()).norm() > kMostAcceleration * squared ||
         logSo3(off.linear()).norm() > kMostTurn * squared;
}

}  // namespace

int CameraPath::advance(Time time, const Pose& T_map_cam) {
  Pose T_cam_world = Pose::Identity();
  if (!frames_.empty()) {
    Pose motion = T_map_cam.inverse() * T_map_cam_;
    const double seconds = time - frames_.back().time;
    guessed_ = frames_.size() > 1 && isJump(motion, expectedMotion(seconds), seconds);
    if (guessed_) motion = expectedMotion(seconds);
    T_cam_world = motion * frames_.back().T_cam_world;
  }
  frames_.push_back({time, normalized(T_cam_world)});
  T_map_cam_ = T_map_cam;
  return newest();
}

double CameraPath::refine(const std::vector<StillSighting>& points) {
  if (points.empty() || frames_.empty()) return 1.0;
  Pose& T_cam_world = frames_.back().T_cam_world;
  const Pose given = T_cam_world;
  const Matrix6 prior = priorInformation(guessed_ ? kGuessed : 1.0);
  int agreeing = 0;
  for (int i = 0; i < kIterations; ++i) {
    Normal normal;
    for (const auto& point : points) add(point, T_cam_world, camera_, sigma_px_, normal);
    agreeing = normal.agreeing;
    const Pose moved = T_cam_world * given.inverse();
    Vector6 so_far;
    so_far << moved.translation(), logSo3(moved.linear());
    const Vector6 step = (normal.A + prior).ldlt().solve(normal.b - prior * so_far);
    Pose correction = Pose::Identity();
    correction.linear() = expSo3(step.tail<3>());
    correction.translation() = step.head<3>();
    T_cam_world = normalized(correction * T_cam_world);
    if (step.norm() < 1e-6) break;
  }
  return agreeing / static_cast<double>(points.size());
}

void CameraPath::forgetBefore(int first_kept) {
  while (first_ < first_kept && frames_.size() > 1) {
    frames_.pop_front();
    ++first_;
  }
}

int CameraPath::firstSince(Time time) const {
  int first = oldest();
  while (first < newest() && timeOf(first) < time - 1e-6) ++first;
  return first;
}

Pose CameraPath::expectedMotion(double ahead) const {
  Pose motion = Pose::Identity();
  if (frames_.size() < 2) return motion;
  const Frame& before = frames_[frames_.size() - 2];
  const double steps = ahead / (frames_.back().time - before.time);
  const Pose step = frames_.back().T_cam_world * before.T_cam_world.inverse();
  motion.linear() = expSo3(steps * logSo3(step.linear()));
  motion.translation() = steps * step.translation();
  return motion;
}

Eigen::Matrix3d CameraPath::R_map_world() const {
  return T_map_cam_.linear() * frames_.back().T_cam_world.linear();
}

}  // namespace headway::detect
