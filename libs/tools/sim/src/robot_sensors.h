// SPDX-License-Identifier: BSD-3-Clause
// Sensors of the robot other than cameras: laser scanner, inertial sensor, wheels, satellite
// receiver.
#pragma once

#include <headway/core/random.h>
#include <headway/geo/geodetic_frame.h>
#include <headway/sim/simulator.h>

#include <optional>
#include <vector>

#include "environment.h"

namespace headway::sim {

/// A 2D laser scanner on the robot: its plane cuts the meshes of everything around.
///
/// Times of flight are taken at one instant; a real scanner takes them in turn.
class LaserScanner {
 public:
  LaserScanner(const LaserParams& params, std::uint64_t seed);

  /// @param statics       static surfaces around the robot
  /// @param actor_meshes  of all actors around, relative to the robot's position
  [[nodiscard]] io::RecordedScan scan(Time time, const Pose& T_world_robot,
                               const std::vector<PlacedMesh>& statics,
                               const std::vector<Mesh>& actor_meshes);

 private:
  /// The segment in which a triangle crosses the scan's plane, as the nearest ranges of its rays.
  void cut(const std::array<Eigen::Vector3d, 3>& triangle, std::vector<double>& ranges) const;
  void addSegment(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                  std::vector<double>& ranges) const;

  LaserParams params_;
  Random random_;
  Pose T_robot_laser_ = Pose::Identity();
};

/// What an inertial sensor and wheel encoders on the robot measure as it moves.
///
/// Noise is that of a small MEMS sensor (gyroscope 0.002 rad/s, accelerometer 0.05 m/s^2, biases
/// of a few times that) and of a car's odometry (0.5 % of scale, 0.01 rad of heading per 10 m).
class MotionSensors {
 public:
  /// @param slip_ratio  of the time, in which the wheels turn twice as fast as the robot moves
  explicit MotionSensors(std::uint64_t seed, double slip_ratio = 0.0);

  /// The robot's pose at the end of each step of the motion; times increase.
  void observe(Time time, const Pose& T_world_robot);

  /// Samples since last taken, one for each pose between two steps.
  [[nodiscard]] std::vector<ImuSample> takeImu();
  /// Where the wheels say the robot is; nullopt before the first step.
  [[nodiscard]] std::optional<OdometrySample> odometry() const { return odometry_; }

 private:
  struct Step {
    double duration_s = 0.0;
    Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< robot frame [rad/s]
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< world [m/s]
  };
  /// What an inertial sensor measures at the last pose, between two steps.
  [[nodiscard]] ImuSample sampleBetween(const Step& before, const Step& after);
  [[nodiscard]] Eigen::Vector3d noise(double sigma);
  void integrateWheels(Time time, const Pose& T_previous_now);

  Random random_;
  Eigen::Vector3d gyro_bias_, accelerometer_bias_;
  double wheel_scale_;
  double slip_ratio_;
  std::optional<Stamped<Pose>> last_;
  std::optional<Step> step_;  ///< the last one
  std::vector<ImuSample> imu_;
  std::optional<OdometrySample> odometry_;
};

/// A satellite receiver on the robot, with independent errors.
class SatelliteReceiver {
 public:
  SatelliteReceiver(const GnssParams& params, std::uint64_t seed);

  /// The robot's pose at the end of each step of the motion; takes a fix if one is due.
  void observe(Time time, const Pose& T_world_robot);
  /// Fixes since last taken.
  [[nodiscard]] std::vector<io::RecordedGnss> take();
  /// Where the robot is and where it looks.
  [[nodiscard]] TruePlace placeOf(Time time, const Pose& T_world_robot) const;

 private:
  GnssParams params_;
  Random random_;
  geo::GeodeticFrame frame_;  ///< at the world's origin
  Pose T_enu_world_ = Pose::Identity();
  std::optional<Time> due_;
  std::vector<io::RecordedGnss> fixes_;
};

}  // namespace headway::sim
