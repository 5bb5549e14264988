// SPDX-License-Identifier: BSD-3-Clause
// Simulated sensors of a trial: a range scanner and a detector of people.
#pragma once

#include <headway/core/detector_noise.h>
#include <headway/sim/crowd.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/math/TPose2D.h>

#include <random>

#include "trial.h"

namespace headway::app {

/// A range scanner of 360 degrees, one ray per degree.
class RangeScanner {
 public:
  RangeScanner(const SensorParams& params, std::uint64_t seed);

  /// Points in the robot's frame, 0.4 m above the ground, that replace those in `out`.
  void scan(const sim::Crowd& crowd, const mrpt::math::TPose2D& robot,
            mrpt::maps::CSimplePointsMap& out);

 private:
  SensorParams params_;
  std::mt19937_64 random_;
};

/// Detector of people with the errors of a real one: noise, misses, duplicates, flips and false
/// alarms.
class NoisyDetector {
 public:
  NoisyDetector(const SensorParams& params, std::uint64_t seed);

  /// Boxes of the people not occluded by other people or pillars.
  [[nodiscard]] Detections detect(const sim::Crowd& crowd, const mrpt::math::TPose2D& robot,
                                  Time time);

 private:
  [[nodiscard]] Detection measured(const Eigen::Vector2d& place, double heading, double radius);
  [[nodiscard]] DetectorNoise noiseOf(double distance_m, double width_m) const;

  SensorParams params_;
  Random random_;
  /// Behind the robot: the tracker accepts only boxes in front of their sensor, and people behind
  /// the robot are detected too.
  Pose T_robot_sensor_;
};

/// The robot's pose on the ground as a rigid motion.
[[nodiscard]] Pose poseOf(const mrpt::math::TPose2D& pose);

}  // namespace headway::app
