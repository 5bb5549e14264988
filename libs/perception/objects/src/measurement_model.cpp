// SPDX-License-Identifier: BSD-3-Clause
// Detections as measurements in the map: their noise, as configured, by score and as learned, and
// the field of view.
#include "measurement_model.h"

#include <headway/core/detection.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <tuple>

namespace headway::objects {
namespace {

// All fields, so that the sorted order does not depend on that of the detections.
auto sortKey(const MeasuredBox& box) {
  const Box2d image = box.box2d.value_or(Box2d{});
  return std::make_tuple(box.position.x(), box.position.y(), box.position.z(), box.yaw,
                         box.size.x(), box.size.y(), box.size.z(), box.score,
                         static_cast<int>(box.object_class), box.detector_id.value_or(-1),
                         image.left, image.top, image.right, image.bottom);
}

bool isBefore(const MeasuredBox& a, const MeasuredBox& b) { return sortKey(a) < sortKey(b); }

}  // namespace

std::vector<MeasuredBox> MeasurementModel::toMap(const Pose& T_map_robot,
                                                 const Detections& detections,
                                                 DropCounts& dropped) const {
  const Pose T_map_sensor = T_map_robot * detections.T_robot_sensor;
  std::vector<MeasuredBox> boxes;
  boxes.reserve(detections.items.size());
  for (Detection detection : detections.items) {
    if (const char* reason = reasonToDrop(detection)) {
      ++dropped[reason];
      continue;
    }
    removeBadCovariance(detection, dropped);
    MeasuredBox box = measured(T_map_sensor, detection);
    if (box.position.allFinite() && box.covariance.allFinite() && std::isfinite(box.yaw)) {
      boxes.insert(std::upper_bound(boxes.begin(), boxes.end(), box, isBefore), std::move(box));
    } else {
      ++dropped["nan_box"];
    }
  }
  return boxes;
}

namespace {

/// Length of the longest objects of a class: cargo bikes, limousines, minibuses, articulated buses
/// and lorries, trams [m].
double maxLength(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kPedestrian:
    case ObjectClass::kPersonSitting:
    case ObjectClass::kCyclist:
      return 3.0;
    case ObjectClass::kCar:
      return 8.0;
    case ObjectClass::kVan:
      return 10.0;
    case ObjectClass::kTruck:
      return 30.0;
    default:
      return 60.0;
  }
}

}  // namespace

const char* MeasurementModel::reasonToDrop(const Detection& detection) const {
  if (!isFinite(detection)) return "nan_box";
  if (detection.score < selection_.min_score) return "low_score";
  if (detection.object_class == ObjectClass::kUnknown && !selection_.track_unknown) {
    return "unknown_class";
  }
  if (!detection.box3d) return "no_3d_box";
  const Box3d& box = *detection.box3d;
  if (!(box.length > 0.0 && box.width > 0.0 && box.height > 0.0)) return "zero_size";
  // What was segmented in the images may be a group that walks together.
  const auto limited_as = detection.mask ? ObjectClass::kUnknown : detection.object_class;
  const double longest = std::max({box.length, box.width, box.height});
  if (longest > maxLength(limited_as)) return "too_large";
  if (!(box.centre.z() > 0.0)) return "behind_camera";
  const bool is_beyond =
      box.centre.norm() > selection_.max_range_m || box.centre.z() > selection_.max_depth_m;
  if (is_beyond) return "too_far";
  return nullptr;
}

MeasuredBox MeasurementModel::measured(const Pose& T_map_sensor, const Detection& detection) const {
  const Box3d& box = *detection.box3d;
  const Eigen::Matrix3d& R = T_map_sensor.linear();
  const Eigen::Matrix3d covariance = R * centreCovariance(detection) * R.transpose();
  const Eigen::Vector3d front = R * frontOf(box);
  MeasuredBox result;
  result.object_class = detection.object_class;
  result.score = detection.score;
  result.position = T_map_sensor * box.centre;
  result.covariance = covariance.topLeftCorner<2, 2>();
  if (detection.centre_covariance) result.shared_covariance = result.covariance;
  result.vertical_variance = covariance(2, 2);
  if (detection.velocity) {
    const MeasuredVelocity velocity = rotated(*detection.velocity, R);
    result.velocity = {velocity.value.head<2>(), velocity.covariance.topLeftCorner<2, 2>(),
                       velocity.age_s};
  }
  result.yaw = wrapAngle(std::atan2(front.y(), front.x()));
  result.yaw_sigma_rad = yawSigma(result);
  result.size = {box.length, box.width, box.height};
  result.size_sigma_m = noise_.size_sigma_m * sigmaAlong(box) / noise_.position_sigma_m;
  result.box2d = detection.box2d;
  result.seen_from = box.centre;
  result.detector_id = detection.detector_id;
  result.evidence = detection.evidence;
  result.searched_track = detection.searched_track;
  result.appearance = detection.appearance;
  return result;
}

// A detector that measures velocities takes the heading from them.
double MeasurementModel::yawSigma(const MeasuredBox& box) const {
  if (!box.velocity) return noise_.yaw_sigma_rad;
  const Eigen::Vector2d across(-std::sin(box.yaw), std::cos(box.yaw));
  const double sigma = std::sqrt(across.dot(box.velocity->covariance * across));
  return std::hypot(noise_.yaw_sigma_rad, std::atan2(sigma, box.velocity->value.norm()));
}

double MeasurementModel::sigmaAlong(const Box3d& box) const {
  return noise_.position_sigma_m + noise_.position_sigma_per_m * box.centre.norm();
}

// The detector's own covariance, else noise that grows with depth: largest along the ray.
Eigen::Matrix3d MeasurementModel::centreCovariance(const Detection& detection) const {
  const Eigen::Vector3d& centre = detection.box3d->centre;
  const double along = sigmaAlong(*detection.box3d);
  const double across = noise_.across_sigma_ratio * along;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  if (detection.centre_covariance) {
    covariance = *detection.centre_covariance;
    covariance.diagonal().array() +=
        noise_.additional_position_sigma_m * noise_.additional_position_sigma_m;
    return covariance;
  }
  const Eigen::Vector3d ray = Eigen::Vector3d(centre.x(), 0.0, centre.z()).normalized();
  covariance = (along * along - across * across) * ray * ray.transpose();
  covariance(0, 0) += across * across;
  covariance(2, 2) += across * across;
  covariance(1, 1) = noise_.vertical_sigma_m * noise_.vertical_sigma_m;
  return covariance;
}

void NoiseScale::learn(const ExpectedPlace& expected, const MeasuredBox& detection) {
  constexpr double kOutlier = 6.0;  // larger distances are clamped
  constexpr double kMinScale = 0.05;
  constexpr double kMaxScale = 4.0;
  const Eigen::Vector2d offset = (detection.position - expected.position).head<2>();
  const Eigen::Matrix2d S = expected.covariance + detection.covariance;
  const double squared = std::min(kOutlier, offset.dot(S.inverse() * offset));
  // Mean of chi-square with two degrees of freedom: 2.
  scale_ *= 1.0 + adaptation_ * (squared / 2.0 - 1.0);
  scale_ = std::clamp(scale_, kMinScale, kMaxScale);
}

MeasuredBox NoiseScale::scaled(MeasuredBox box) const {
  box.covariance *= scale_ * scale_;
  box.shared_covariance *= std::max(0.0, 1.0 - scale_ * scale_);
  box.vertical_variance *= scale_ * scale_;
  return box;
}

// Welford's update.
void ScoreQuality::learn(const MeasuredBox& box) {
  Scores& scores = scores_[static_cast<std::size_t>(box.object_class)];
  const double before = box.score - scores.mean;
  ++scores.count;
  scores.mean += before / static_cast<double>(scores.count);
  scores.squares += before * (box.score - scores.mean);
}

MeasuredBox ScoreQuality::scaled(MeasuredBox box) const {
  constexpr double kNoiseOfOneSigma = 1.4;  ///< ratio of the noise one standard deviation lower
  const Scores& scores = scores_[static_cast<std::size_t>(box.object_class)];
  const double sigma =
      std::sqrt(scores.squares / static_cast<double>(std::max<std::size_t>(scores.count, 1)));
  if (!(sigma > 0.0)) return box;
  const double above = std::clamp((box.score - scores.mean) / sigma, -2.0, 2.0);
  box.size_sigma_m *= std::pow(kNoiseOfOneSigma, -above);
  return box;
}

}  // namespace headway::objects
