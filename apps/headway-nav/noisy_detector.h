#pragma once

#include <headway/core/detection.h>
#include <mrpt/math/TPose2D.h>

#include "crowd.h"

namespace headway::app {

/// A detector of people as detectors are: with noise, misses, doubles, flips and false alarms.
class NoisyDetector {
 public:
  NoisyDetector(const SensorParams& params, std::uint64_t seed);

  /// Boxes of the people whom nobody and nothing hides.
  [[nodiscard]] Detections detect(const Crowd& crowd, const mrpt::math::TPose2D& robot, Time time);

 private:
  [[nodiscard]] Detection boxOf(const Eigen::Vector2d& place, double heading, double radius);
  [[nodiscard]] Eigen::Vector2d blurred(const Eigen::Vector2d& place);
  [[nodiscard]] Eigen::Matrix3d covarianceAt(const Eigen::Vector2d& place) const;
  [[nodiscard]] bool happens(double share);
  [[nodiscard]] double normal(double sigma);

  SensorParams params_;
  Random random_;
  /// Behind the robot: the tracker believes only boxes before their sensor, and people behind the
  /// robot are seen too.
  Pose T_robot_sensor_;
};

/// The robot's pose on the ground as a rigid motion.
[[nodiscard]] Pose poseOf(const mrpt::math::TPose2D& pose);

}  // namespace headway::app
