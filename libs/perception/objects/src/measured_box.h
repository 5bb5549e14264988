// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>

#include <Eigen/Core>
#include <optional>

namespace headway::objects {

/// A velocity over the ground.
struct GroundVelocity {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();           ///< (x, y), map frame [m/s]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< [m^2/s^2]
};

/// A detection in the map frame, with its noise.
struct MeasuredBox {
  ObjectClass object_class = ObjectClass::kUnknown;
  double score = 0.0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< centre, map frame [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of (x, y), map frame [m^2]
  double vertical_variance = 1.0;                            ///< of z, map frame [m^2]
  std::optional<GroundVelocity> velocity;                    ///< if the detector measured it
  double yaw = 0.0;                                          ///< of the front about map z [rad]
  double yaw_sigma_rad = 0.15;                               ///< its noise
  Eigen::Vector3d size = Eigen::Vector3d::Ones();            ///< (length, width, height) [m]
  double size_sigma_m = 0.2;                                 ///< noise of each of them [m]
  std::optional<Box2d> box2d;                                ///< [px]
  Eigen::Vector3d seen_from = Eigen::Vector3d::UnitZ();      ///< centre, optical frame [m]
  std::optional<std::int64_t> detector_id;
  DetectionEvidence evidence;
  std::optional<TrackId> searched_track;
  std::shared_ptr<const AppearanceTemplate> appearance;

  /// Whether the class is derived from size and speed, so that it may change between frames.
  [[nodiscard]] bool classIsProvisional() const {
    return !evidence.classifier && (evidence.motion || evidence.flow || evidence.appearance);
  }
};

}  // namespace headway::objects
