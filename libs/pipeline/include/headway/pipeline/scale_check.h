// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/core/warnings.h>

#include <deque>
#include <optional>

namespace headway::pipeline {

/// Compares the camera's distances with those of wheel odometry, over pieces of 2 m.
///
/// A wrong baseline or focal length scales all depths and with them the map, which nothing in the
/// images shows. Wheels have errors of their own (pressure, slip), so that a difference is said and
/// not applied. The median over the pieces is robust against slip in less than half of them.
class ScaleCheck {
 public:
  /// Takes the robot's motion since the previous frame, and adds "odometry_scale" for each piece at
  /// whose end the scales differ, surely, by more than 1 %.
  void add(const Pose& by_camera, const std::optional<Pose>& by_odometry, std::size_t frame,
           Warnings& warnings);

  /// The motion since the previous frame is unknown, so that a new piece begins.
  void interrupt() { piece_ = {}; }

  /// Distances were measured by another calibration until now.
  void restart() { *this = ScaleCheck(); }

  /// Distance by the camera to distance by the wheels.
  struct Ratio {
    double value = 1.0;
    double sigma = 0.0;
  };
  /// Of the newest 400 m; nullopt before 10 m.
  [[nodiscard]] std::optional<Ratio> ratio() const;

 private:
  struct Piece {
    Pose by_camera = Pose::Identity();
    Pose by_odometry = Pose::Identity();
    double path_m = 0.0;  ///< by odometry
  };
  Piece piece_;
  std::deque<double> ratios_;  ///< of the newest pieces
};

}  // namespace headway::pipeline
