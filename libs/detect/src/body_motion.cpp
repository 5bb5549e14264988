#include "body_motion.h"

#include <headway/core/statistics.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "over_ground.h"

namespace headway::detect {
namespace {

constexpr double kTail = 4.0;  // squared distance from which a part weighs half
constexpr int kIterations = 5;
constexpr double kMedianLoss = 1.25;  // standard error of a median over that of a mean
constexpr double kLeastSpan = 0.25;   // of sightings [s]

// Velocity of one part over the ground: along the line of sight, and across it.
struct Part {
  Eigen::Vector2d velocity;
  Eigen::Matrix2d information;
};

// Axes over the ground: along the line of sight to the body, and across it.
using Axes = Eigen::Matrix<double, 3, 2>;

Axes axesTo(const UprightBlob& body, const CameraPath& path, const StereoCamera& camera,
            const Eigen::Vector3d& up) {
  const Eigen::Vector3d ray =
      path.T_cam_world(path.newest()).linear().transpose() * *triangulate(body.uvd, camera);
  Axes axes;
  axes.col(0) = overGround(ray, up).normalized();
  axes.col(1) = up.cross(axes.col(0));
  return axes;
}

Part partOf(const PointMotion& motion, const Axes& axes, double scale) {
  const Eigen::Matrix2d covariance = axes.transpose() * motion.velocity_covariance * axes;
  return {axes.transpose() * motion.velocity, (scale * scale * covariance).inverse()};
}

// What the flows of some frames say: their median, as surely as they agree; of the speed along the
// line of sight nothing but how fast walkers are.
Part partOf(const std::deque<AcrossSpeed>& across, const Axes& axes, const Eigen::Vector3d& right,
            double speed_prior) {
  std::vector<double> speeds;
  std::vector<double> errors;
  for (const auto& flow : across) speeds.push_back(flow.speed);
  const double middle = median(speeds);
  for (const auto& flow : across) {
    errors.push_back(std::max(flow.sigma, std::abs(flow.speed - middle)));
  }
  const double sigma = kMedianLoss * median(errors);
  const double side = right.dot(axes.col(1)) < 0.0 ? -1.0 : 1.0;
  const double along = 1.0 / (speed_prior * speed_prior);
  const double information = static_cast<double>(across.size()) / (sigma * sigma);
  return {{0.0, side * middle}, Eigen::Vector2d(along, information).asDiagonal()};
}

// A mean that parts far from it hardly move.
struct Pooled {
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
};

Pooled pool(const std::vector<Part>& parts) {
  Pooled pooled;
  for (int i = 0; i < kIterations; ++i) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    for (const auto& part : parts) {
      const Eigen::Vector2d off = part.velocity - pooled.velocity;
      const double squared = i == 0 ? 0.0 : off.dot(part.information * off);
      const Eigen::Matrix2d weighed = part.information / (1.0 + squared / kTail);
      information += weighed;
      sum += weighed * part.velocity;
    }
    pooled.information = information;
    pooled.velocity = information.ldlt().solve(sum);
  }
  return pooled;
}

// Of the camera, mean over its path [m/s].
double speedOf(const CameraPath& path) {
  const double seconds = path.timeOf(path.newest()) - path.timeOf(path.oldest());
  if (seconds <= 0.0) return 0.0;
  const Pose T = path.T_cam_world(path.newest()) * path.T_cam_world(path.oldest()).inverse();
  return T.translation().norm() / seconds;
}

}  // namespace

std::optional<BodyMotion> bodyMotion(const UprightBlob& body,
                                     const std::optional<PointMotion>& outline,
                                     const std::deque<AcrossSpeed>& across,
                                     const std::vector<PointTrack>& points,
                                     const stereo::DisparityImage& disparity,
                                     const CameraPath& path, const StereoCamera& camera,
                                     const Eigen::Vector3d& up, const BodyParams& params) {
  cv::Mat inside(disparity.values.size(), CV_8U, cv::Scalar(0));
  for (const auto& cell : body.cells) inside.at<unsigned char>(cell.place) = 1;
  const Axes axes = axesTo(body, path, camera, up);
  const Time now = path.timeOf(path.newest());
  const SightingNoise noise;
  std::vector<Part> parts;
  double span = 0.0;
  for (const auto& point : points) {
    const auto& uvd = point.sightings.back().uvd;
    const cv::Point cell(disparity.cellOf(uvd.x()), disparity.cellOf(uvd.y()));
    const bool here =
        cv::Rect({0, 0}, inside.size()).contains(cell) && inside.at<unsigned char>(cell) != 0;
    if (!here || static_cast<int>(point.sightings.size()) < params.least_sightings) continue;
    const double seen = now - path.timeOf(point.sightings.front().frame);
    if (seen < kLeastSpan) continue;
    const auto motion = fitMotion(point.sightings, path, camera, noise, params.speed_prior);
    if (!motion) continue;
    const double scale = std::max(params.noise_scale, std::sqrt(motion->movingFit()));
    parts.push_back(partOf(*motion, axes, scale));
    span = std::max(span, seen);
  }
  if (outline) {
    parts.push_back(partOf(*outline, axes, 1.0));
    span = std::max(span, kLeastSpan);
  }
  const bool flows = static_cast<int>(across.size()) >= params.least_flows;
  if (flows) {
    const Eigen::Vector3d right = path.T_cam_world(path.newest()).linear().row(0);
    parts.push_back(partOf(across, axes, right, params.speed_prior));
    double seconds = 0.0;
    for (const auto& flow : across) seconds += flow.seconds;
    span = std::max(span, seconds);
  }
  if (static_cast<int>(parts.size()) < params.least_parts && !flows) return std::nullopt;

  const Pooled pooled = pool(parts);
  const double depth = camera.fx * camera.baseline_m / body.uvd.z();
  const double along = params.common_disparity_px * depth / body.uvd.z() / span;
  const double common_across = params.common_px * depth / camera.fx / span;
  const double slip = params.common_share * speedOf(path);
  Eigen::Matrix2d covariance = pooled.information.inverse();
  covariance.diagonal() +=
      Eigen::Vector2d(along * along + slip * slip, common_across * common_across + slip * slip);
  BodyMotion motion;
  motion.velocity = axes * pooled.velocity;
  motion.covariance = axes * covariance * axes.transpose();
  motion.evidence = pooled.velocity.dot(covariance.inverse() * pooled.velocity);
  if (flows) {
    motion.across = std::abs(parts.back().velocity.y());
    motion.across_sigma = std::sqrt(covariance(1, 1));
  }
  motion.parts = static_cast<int>(parts.size());
  return motion;
}

}  // namespace headway::detect
