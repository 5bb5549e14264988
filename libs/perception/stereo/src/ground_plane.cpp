// SPDX-License-Identifier: BSD-3-Clause
// The ground: its plane in the camera frame, and disparities that are matched along it.
#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/rig_capability.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "block_matcher.h"

namespace headway::stereo {
namespace {

/// The search for the plane.
struct PlaneSearch {
  int step = 4;     ///< cells from sample to sample
  int trials = 80;  ///< of planes through three points: finds one with a third of them
  double min_tilt_cosine = 0.985;  ///< 10 degrees against the mounting
  double min_height_m = 0.2;       ///< of the camera, unless it is mounted lower
  double max_height_m = 4.0;
  double min_ratio = 0.15;  ///< of the points that must lie on the plane
  // A robot stands on the ground that it sees: where a kerb parts two levels, a tilted plane
  // through both has most points. By how much wheels, springs and slopes move the plane before the
  // camera:
  double sigma_tilt = 0.02;    ///< [rad]
  double sigma_height = 0.04;  ///< of the mounted height
};
constexpr PlaneSearch kSearch;
constexpr double kRoughness = 0.01;     ///< of the ground [m]
constexpr double kTiltSigma = 0.00175;  ///< 0.1 degrees: bends of the ground and of the rig [rad]

using Points = std::vector<Eigen::Vector3d>;

/// The search for a floor wherever it is: what a mounting may be wrong by.
struct FloorSearch {
  int step = 6;
  int trials = 300;              ///< finds one with a quarter of the points
  double min_tilt_cosine = 0.7;  ///< 45 degrees: beyond, a wall may be meant
  double max_below = 0.05;       ///< points below the plane, to those on it: reflections
  double min_ratio = 0.1;        ///< of the points that lie on the plane
};
constexpr FloorSearch kFloor;

/// Limits of the search for a rig; those of a car's are the reference.
struct SearchLimits {
  SearchLimits(const StereoCamera& camera, const RigCapability& rig)
      : expected(groundPlane(rig, mountedUp(camera), 0.0)) {
    near_m = rig.nearest_m;
    far_m = rig.ground_to_m;
    if (rig.camera_height_known) {
      expected.camera_height = rig.camera_height_m;
      min_height_m = std::min(kSearch.min_height_m, 0.5 * rig.camera_height_m);
    }
    const double scale = std::min(1.0, far_m / 25.0);
    min_area_m2 = 0.2 * scale * scale;
    from_row_px = camera.cy;
  }
  GroundPlane expected;                        ///< as the camera is mounted; height 0: not known
  double near_m;                               ///< minimum depth of points of the ground
  double far_m;                                ///< maximum depth of points of the ground
  double min_height_m = kSearch.min_height_m;  ///< of the camera above the ground
  double min_area_m2;                          ///< of the parallelogram of three sampled points
  double max_height_m = kSearch.max_height_m;
  double min_tilt_cosine = kSearch.min_tilt_cosine;
  double from_row_px;
  int step = kSearch.step;
  bool trusts_mounting = true;
};

Points pointsOf(const DisparityImage& disparity, const StereoCamera& camera,
                const SearchLimits& limits) {
  Points points;
  const double fb = camera.fx * camera.baseline_m;
  for (int row = std::max(0, disparity.cellOf(limits.from_row_px)); row < disparity.values.rows;
       row += limits.step) {
    for (int column = 0; column < disparity.values.cols; column += limits.step) {
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
  return plane.up.dot(limits.expected.up) > limits.min_tilt_cosine &&
         plane.camera_height > limits.min_height_m && plane.camera_height < limits.max_height_m;
}

// Points on the plane, less those below it, since nothing is visible below the ground.
double support(const GroundPlane& plane, const Points& points) {
  double total = 0.0;
  for (const auto& point : points) {
    const double height = plane.heightOf(point);
    const double tolerance = plane.tolerance(point.z());
    if (std::abs(height) < tolerance) total += 1.0;
    if (height < -2.0 * tolerance) total -= 1.0;
  }
  return total;
}

// How likely a plane is by the camera's mounting, 0 to 1, with the tails of slopes and ramps
// (Cauchy).
double prior(const GroundPlane& plane, const GroundPlane& expected) {
  const double tilt = std::acos(std::min(1.0, plane.up.dot(expected.up))) / kSearch.sigma_tilt;
  const double height =
      expected.camera_height > 0.0
          ? (plane.camera_height / expected.camera_height - 1.0) / kSearch.sigma_height
          : 0.0;
  return 1.0 / (1.0 + tilt * tilt + height * height);
}

double score(const GroundPlane& plane, const Points& points, const SearchLimits& limits) {
  const double weight = limits.trusts_mounting ? prior(plane, limits.expected) : 1.0;
  return weight * support(plane, points);
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

namespace {

/// The plane with the best score among those through three of the points.
///
/// @param best_score  of `best`, which is returned if no other is better
GroundPlane sampledPlane(const Points& points, const SearchLimits& limits, int trials,
                         GroundPlane best, double& best_score) {
  std::mt19937 random(1);
  const auto draw = [&] { return points[random() % points.size()]; };
  for (int trial = 0; trial < trials; ++trial) {
    const Eigen::Vector3d a = draw(), b = draw(), c = draw();
    const Eigen::Vector3d normal = (b - a).cross(c - a);
    if (normal.norm() < limits.min_area_m2) continue;
    const auto plane = planeThrough(a, normal, limits.expected);
    if (!plausible(plane, limits)) continue;
    const double plane_score = score(plane, points, limits);
    if (plane_score <= best_score) continue;
    best = plane;
    best_score = plane_score;
  }
  return best;
}

}  // namespace

std::optional<GroundPlane> findGround(const DisparityImage& disparity, const StereoCamera& camera,
                                      const std::optional<GroundPlane>& previous) {
  const SearchLimits limits(camera, rigCapability(camera));
  const Points points = pointsOf(disparity, camera, limits);
  if (points.size() < 50) return std::nullopt;
  const GroundPlane first = previous.value_or(limits.expected);
  double best_score = previous ? score(first, points, limits) : 0.0;
  const GroundPlane best = sampledPlane(points, limits, kSearch.trials, first, best_score);
  if (support(best, points) < kSearch.min_ratio * static_cast<double>(points.size())) {
    return std::nullopt;
  }
  return refined(best, points, limits);
}

std::optional<GroundPlane> findFloor(const DisparityImage& disparity, const StereoCamera& camera) {
  SearchLimits limits(camera, rigCapability(camera));
  limits.trusts_mounting = false;
  limits.near_m = 0.0;
  limits.min_height_m = 0.0;
  limits.max_height_m = limits.far_m;
  limits.min_tilt_cosine = kFloor.min_tilt_cosine;
  limits.from_row_px = 0.0;
  limits.step = kFloor.step;
  const Points points = pointsOf(disparity, camera, limits);
  if (points.size() < 50) return std::nullopt;
  double best_score = 0.0;
  const auto plane = refined(
      sampledPlane(points, limits, kFloor.trials, limits.expected, best_score), points, limits);
  double on = 0.0, below = 0.0;
  for (const auto& point : points) {
    const double height = plane.heightOf(point), tolerance = plane.tolerance(point.z());
    if (std::abs(height) < tolerance) on += 1.0;
    if (height < -2.0 * tolerance) below += 1.0;
  }
  const bool is_seen = on >= kFloor.min_ratio * static_cast<double>(points.size());
  return is_seen && below <= kFloor.max_below * on ? std::optional(plane) : std::nullopt;
}

namespace {

constexpr int kResiduals = 16;       // whole pixels that are searched, half of them on either side
constexpr int kWindow = 7;           // in which matches support each other [reduced px]
constexpr double kMinDensity = 0.3;  // of them; of what is not the ground, an eighth fits by chance
constexpr double kMinSlope = 1e-3;   // of the disparity, from row to row: a camera looks ahead

/// Disparity of a plane in the cells of a reduced image, in which it is linear [its pixels].
struct PlaneDisparity {
  double by_column, by_row, first;

  PlaneDisparity(const StereoCamera& camera, const GroundPlane& ground, int reduce) {
    const Eigen::Vector3d scaled =
        -camera.fx * camera.baseline_m / ground.camera_height * ground.up;
    by_column = scaled.x() / camera.fx;
    by_row = scaled.y() / camera.fy;
    const double pixel = 0.5 * (reduce - 1);  // of the first cell
    first = (scaled.z() + (pixel - camera.cx) * by_column + (pixel - camera.cy) * by_row) / reduce;
  }
  [[nodiscard]] double at(double column, double row) const {
    return first + by_column * column + by_row * row;
  }
  /// First row in which it is as great as a value anywhere.
  [[nodiscard]] double rowOf(double value, int columns) const {
    return (value - std::max(first, at(columns - 1.0, 0.0))) / by_row;
  }
  /// What maps an image's rows from one on to a right image in which the plane has no disparity.
  [[nodiscard]] cv::Matx23d shear(int from_row) const {
    return {1.0 - by_column, -by_row, -at(0.0, from_row), 0.0, 1.0, 0.0};
  }
};

/// Disparities less the plane's; less than -kResiduals / 2 where there are none [px / kSubpixels].
cv::Mat matchResiduals(const cv::Mat& left, const cv::Mat& sheared, int block_px) {
  auto matcher = blockMatcher(kResiduals, block_px);
  matcher->setMinDisparity(-kResiduals / 2);
  matcher->setUniquenessRatio(0);
  // Not both ways and with speckles, which is twice as fast: dropScattered() removes them.
  matcher->setDisp12MaxDiff(-1);
  matcher->setSpeckleWindowSize(0);
  cv::Mat residuals;
  matcher->compute(left, sheared, residuals);
  return residuals;
}

/// Disparities within the plane's tolerance in a row, and not less than the least one.
void enterRow(const std::int16_t* residuals, const PlaneDisparity& plane, const GroundPlane& ground,
              int row, double focal_baseline, double least, cv::Mat& values) {
  const double middle = plane.at(0.5 * values.cols, row);
  if (!(middle > 0.0)) return;
  // A point at height h above the plane has 1 / (1 - h / H) times its disparity.
  const double ratio = ground.tolerance(focal_baseline / middle) / ground.camera_height;
  auto* value = values.ptr<float>(row);
  for (int column = 0; column < values.cols; ++column) {
    if (residuals[column] < -kResiduals / 2 * kSubpixels) continue;
    const double rest = residuals[column] / static_cast<double>(kSubpixels);
    const double matched = rest + plane.at(column - rest, row);
    const bool is_ground = std::abs(matched - plane.at(column, row)) <= ratio * matched;
    if (is_ground && matched >= least) value[column] = static_cast<float>(matched);
  }
}

/// Removes matches of which too few are around.
void dropScattered(cv::Mat& values) {
  cv::Mat density;
  const cv::Mat matched = values > 0.0F;
  cv::blur(matched, density, {kWindow, kWindow});
  values.setTo(0.0F, density < kMinDensity * 255.0);
}

}  // namespace

DisparityImage groundDisparity(const StereoFrame& frame, const GroundPlane& ground,
                               const DisparityParams& params, double to_m) {
  const StereoCamera& camera = *frame.camera;
  const int reduce = params.reduce;
  const int block_px = params.block_px | 1;
  DisparityImage result;
  result.reduce = reduce;
  const cv::Size size(frame.left.cols / reduce, frame.left.rows / reduce);
  result.values = cv::Mat(size, CV_32F, cv::Scalar(0));
  const PlaneDisparity plane(camera, ground, reduce);
  if (!frame.disparity.empty() || !(plane.by_row > kMinSlope)) return result;
  const double focal_baseline = camera.fx * camera.baseline_m / reduce;
  const double least = focal_baseline / to_m;
  const double horizon = std::clamp<double>(plane.rowOf(least, size.width), 0.0, size.height);
  const int from = std::max(0, static_cast<int>(horizon) - block_px);
  if (size.height - from <= 2 * block_px || size.width <= 2 * kResiduals) return result;
  const auto below = [&](const cv::Mat& image) {
    return reducedImage(image, reduce).rowRange(from, size.height);
  };
  const cv::Mat left = below(frame.left), right = below(frame.right);
  cv::Mat sheared;
  cv::warpAffine(right, sheared, plane.shear(from), left.size(),
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
  const cv::Mat residuals = matchResiduals(left, sheared, block_px);
  for (int row = from; row < size.height; ++row) {
    enterRow(residuals.ptr<std::int16_t>(row - from), plane, ground, row, focal_baseline, least,
             result.values);
  }
  cv::Mat matched = result.values.rowRange(from, size.height);
  dropScattered(matched);
  matched *= reduce;
  return result;
}

}  // namespace headway::stereo
