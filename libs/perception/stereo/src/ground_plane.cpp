// SPDX-License-Identifier: BSD-3-Clause
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/rig_capability.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <vector>

namespace headway::stereo {
namespace {

constexpr int kStep = 4;  // cells from sample to sample
constexpr int kTrials = 80;
constexpr double kMaxTiltCosine = 0.985;  // 10 degrees
constexpr double kLowest = 0.2;           // camera above ground, unless mounted lower [m]
constexpr double kHighest = 4.0;          // [m]
constexpr double kMinRatio = 0.15;        // of the points that must lie on the plane
constexpr double kRoughness = 0.01;       // of the ground [m]
constexpr double kTiltSigma = 0.00175;    // 0.1 degrees: bends of the ground and of the rig
constexpr double kGroundRatio = 0.5;      // of the minimum height of an obstacle: lower is ground

using Points = std::vector<Eigen::Vector3d>;

/// Limits of the search for a rig; those of a car's are the reference.
struct SearchLimits {
  SearchLimits(const StereoCamera& camera, const RigCapability& rig)
      : expected(groundPlane(rig, mountedUp(camera), 0.0)) {
    near_m = rig.nearest_m;
    far_m = rig.ground_to_m;
    if (rig.camera_height_known) min_height_m = std::min(kLowest, 0.5 * rig.camera_height_m);
    const double scale = std::min(1.0, far_m / 25.0);
    min_area_m2 = 0.2 * scale * scale;
  }
  GroundPlane expected;           ///< as the camera is mounted, height aside
  double near_m;                  ///< minimum depth of points of the ground
  double far_m;                   ///< maximum depth of points of the ground
  double min_height_m = kLowest;  ///< of the camera above the ground
  double min_area_m2;             ///< of the parallelogram of three sampled points
};

Points pointsBelowHorizon(const DisparityImage& disparity, const StereoCamera& camera,
                          const SearchLimits& limits) {
  Points points;
  const double fb = camera.fx * camera.baseline_m;
  for (int row = std::max(0, disparity.cellOf(camera.cy)); row < disparity.values.rows;
       row += kStep) {
    for (int column = 0; column < disparity.values.cols; column += kStep) {
      const double d = disparity.values.at<float>(row, column);
      if (d < fb / limits.far_m || d > fb / limits.near_m) continue;
      const double z = fb / d;
      points.emplace_back(z * (disparity.pixelOf(column) - camera.cx) / camera.fx,
                          z * (disparity.pixelOf(row) - camera.cy) / camera.fy, z);
    }
  }
  return points;
}

bool plausible(const GroundPlane& plane, const SearchLimits& limits) {
  return plane.up.dot(limits.expected.up) > kMaxTiltCosine &&
         plane.camera_height > limits.min_height_m && plane.camera_height < kHighest;
}

// Points on the plane, less those below it, since nothing is visible below the ground.
double score(const GroundPlane& plane, const Points& points) {
  double total = 0.0;
  for (const auto& point : points) {
    const double height = plane.heightOf(point);
    const double tolerance = plane.tolerance(point.z());
    if (std::abs(height) < tolerance) total += 1.0;
    if (height < -2.0 * tolerance) total -= 1.0;
  }
  return total;
}

GroundPlane planeThrough(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                         const GroundPlane& expected) {
  GroundPlane plane = expected;
  plane.up = normal.normalized();
  if (plane.up.dot(expected.up) < 0.0) plane.up = -plane.up;
  plane.camera_height = -plane.up.dot(point);
  return plane;
}

GroundPlane refined(GroundPlane plane, const Points& points, const SearchLimits& limits) {
  for (int i = 0; i < 2; ++i) {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double count = 0.0;
    for (const auto& point : points) {
      const double tolerance = plane.tolerance(point.z());
      if (std::abs(plane.heightOf(point)) > tolerance) continue;
      const double weight = 1.0 / (tolerance * tolerance);
      mean += weight * point;
      squares += weight * point * point.transpose();
      count += weight;
    }
    if (!(count > 0.0)) return plane;
    mean /= count;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(squares / count -
                                                              mean * mean.transpose());
    const auto next = planeThrough(mean, axes.eigenvectors().col(0), limits.expected);
    if (!plausible(next, limits)) return plane;
    plane = next;
  }
  return plane;
}

}  // namespace

double GroundPlane::heightSigma(double depth) const {
  return std::hypot(kRoughness, sigma_per_m * depth);
}

GroundPlane groundPlane(const RigCapability& rig, const Eigen::Vector3d& up, double camera_height) {
  const double by_disparity = rig.sigma_disparity_px * rig.camera_height_m / rig.focal_baseline;
  return {up, camera_height, std::hypot(by_disparity, kTiltSigma),
          kGroundRatio * rig.min_obstacle_height_m};
}

Eigen::Vector3d mountedUp(const StereoCamera& camera) {
  return camera.T_robot_cam.linear().transpose() * Eigen::Vector3d::UnitZ();
}

std::optional<GroundPlane> findGround(const DisparityImage& disparity, const StereoCamera& camera,
                                      const std::optional<GroundPlane>& previous) {
  const SearchLimits limits(camera, rigCapability(camera));
  const Points points = pointsBelowHorizon(disparity, camera, limits);
  if (points.size() < 50) return std::nullopt;
  GroundPlane best = previous.value_or(limits.expected);
  double best_score = previous ? score(best, points) : 0.0;
  std::mt19937 random(1);
  const auto draw = [&] { return points[random() % points.size()]; };
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d a = draw(), b = draw(), c = draw();
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < limits.min_area_m2) continue;
    const auto plane = planeThrough(a, normal, limits.expected);
    if (!plausible(plane, limits)) continue;
    const double plane_score = score(plane, points);
    if (plane_score <= best_score) continue;
    best = plane;
    best_score = plane_score;
  }
  if (best_score < kMinRatio * static_cast<double>(points.size())) return std::nullopt;
  return refined(best, points, limits);
}

}  // namespace headway::stereo
