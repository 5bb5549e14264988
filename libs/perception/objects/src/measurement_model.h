// SPDX-License-Identifier: BSD-3-Clause
// Detections as measurements in the map: their noise, as configured, by score and as learned, and
// the field of view.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

namespace headway::objects {

/// A velocity over the ground.
struct GroundVelocity {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();           ///< (x, y), map frame [m/s]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< [m^2/s^2]
  double age_s = 0.0;                                        ///< see MeasuredVelocity [s]
};

/// A detection in the map frame, with its noise.
struct MeasuredBox {
  ObjectClass object_class = ObjectClass::kUnknown;
  double score = 0.0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< centre, map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of (x, y), map frame [m^2]
  /// Part of the centre's error that consecutive detections share, as the visible part of a body
  /// does: a filter does not average it out. Of (x, y), map frame [m^2].
  Eigen::Matrix2d shared_covariance = Eigen::Matrix2d::Zero();
  double vertical_variance = 1.0;                        ///< of z, map frame [m^2]
  std::optional<GroundVelocity> velocity;                ///< if the detector measured it
  double yaw = 0.0;                                      ///< of the front about map z [rad]
  double yaw_sigma_rad = 0.15;                           ///< its noise
  Eigen::Vector3d size = Eigen::Vector3d::Ones();        ///< (length, width, height) [m]
  double size_sigma_m = 0.2;                             ///< noise of each of them [m]
  std::optional<Box2d> box2d;                            ///< [px]
  Eigen::Vector3d seen_from = Eigen::Vector3d::UnitZ();  ///< centre, optical frame [m]
  std::optional<std::int64_t> detector_id;
  DetectionEvidence evidence;
  std::optional<TrackId> searched_track;
  std::shared_ptr<const AppearanceTemplate> appearance;

  /// Whether the class is derived from size and speed, so that it may change between frames.
  [[nodiscard]] bool classIsProvisional() const {
    return !evidence.classifier && (evidence.motion || evidence.change || evidence.appearance);
  }
};

/// Predicted place of a track in this frame.
struct ExpectedPlace {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of (x, y) [m^2]
  double vertical_variance = 0.0;                            ///< of z [m^2]
  ObjectClass object_class = ObjectClass::kUnknown;
  std::optional<std::int64_t> detector_id;
  TrackId track;
};

/// Transforms detections from the sensor's frame to the map and assigns their noise.
///
/// Reasons to drop a detection: low_score, unknown_class, no_3d_box, nan_box, zero_size,
/// too_large, behind_camera, too_far. A covariance that cannot be one is dropped without its box
/// (bad_covariance).
class MeasurementModel {
 public:
  MeasurementModel(const ConsistencyParams& selection, const FilterParams& noise)
      : selection_(selection), noise_(noise) {}

  /// @param dropped  counts the dropped detections by reason
  /// @return         in an order that does not depend on that of the detections
  [[nodiscard]] std::vector<MeasuredBox> toMap(const Pose& T_map_robot,
                                               const Detections& detections,
                                               DropCounts& dropped) const;

 private:
  /// Reason why a detection cannot be used; nullptr if it can.
  [[nodiscard]] const char* reasonToDrop(const Detection& detection) const;
  [[nodiscard]] MeasuredBox measured(const Pose& T_map_sensor, const Detection& detection) const;
  /// Noise of the heading [rad].
  [[nodiscard]] double yawSigma(const MeasuredBox& box) const;
  /// Noise of the centre along the viewing ray [m].
  [[nodiscard]] double sigmaAlong(const Box3d& box) const;
  [[nodiscard]] Eigen::Matrix3d centreCovariance(const Detection& detection) const;

  ConsistencyParams selection_;
  FilterParams noise_;
};

/// Online estimate of the ratio of a detector's true noise to its configured noise.
///
/// With correct noise the mean squared Mahalanobis distance of a detection from its prediction is 2
/// (chi-squared). Larger distances increase the scale, smaller ones decrease it.
///
/// @see Bar-Shalom et al. 2001, "Estimation with applications to tracking and navigation", 5.4
class NoiseScale {
 public:
  /// @param adaptation  rate at which the scale follows the distances; 0 keeps it at 1
  explicit NoiseScale(double adaptation) : adaptation_(adaptation) {}

  /// Updates the scale by the distance of a detection from its prediction.
  void learn(const ExpectedPlace& expected, const MeasuredBox& detection);

  /// The box with its noise scaled. What a detector states beyond that is shared by consecutive
  /// detections; a configured noise states nothing.
  [[nodiscard]] MeasuredBox scaled(MeasuredBox box) const;

  /// Factor on the standard deviations.
  [[nodiscard]] double value() const { return scale_; }

 private:
  double adaptation_;
  double scale_ = 1.0;
};

/// How good a box is, by its detector's score.
///
/// The scale of a score is the detector's own; its rank among the scores of the same class tells
/// near and unoccluded views from others. PointRCNN's boxes of cars, for example, have lengths to
/// within 0.19 m where the score is one standard deviation above the mean and 0.41 m where it is
/// one and a half below, at any range.
class ScoreQuality {
 public:
  /// Updates mean and standard deviation of the scores of the box's class.
  void learn(const MeasuredBox& box);

  /// The box with the noise of its size scaled: less for a score above the mean, more below.
  [[nodiscard]] MeasuredBox scaled(MeasuredBox box) const;

 private:
  struct Scores {
    std::size_t count = 0;
    double mean = 0.0;
    double squares = 0.0;  ///< sum of the squared deviations from the mean
  };
  std::array<Scores, kObjectClassCount> scores_{};
};

/// Field of view of the detector, estimated from the largest bearing at which it has followed an
/// object: a false detection beside it does not widen it.
///
/// An undetected object outside of it is not a missed detection.
class FieldOfView {
 public:
  /// Sets the pose of the sensor.
  void move(const Pose& T_map_sensor) { T_sensor_map_ = T_map_sensor.inverse(); }

  /// Widens the field of view to where a confirmed object was detected, in the map.
  void widenTo(const Eigen::Vector3d& place) {
    const Eigen::Vector3d seen = inSensor(place);
    if (seen.z() > 0.0) max_tangent_ = std::max(max_tangent_, std::abs(seen.x()) / seen.z());
  }

  /// Whether a position in the map is in front, within the largest bearing so far.
  [[nodiscard]] bool covers(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d seen = inSensor(place);
    return seen.z() > 0.0 && std::abs(seen.x()) <= max_tangent_ * seen.z();
  }

  /// A position of the map in the sensor's optical frame [m].
  [[nodiscard]] Eigen::Vector3d inSensor(const Eigen::Vector3d& place) const {
    return T_sensor_map_ * place;
  }

 private:
  Pose T_sensor_map_ = Pose::Identity();
  double max_tangent_ = 0.0;  ///< tangent of the largest bearing so far
};

}  // namespace headway::objects
