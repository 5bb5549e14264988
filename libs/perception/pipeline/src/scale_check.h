// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/pipeline/perception_update.h>

#include <deque>

namespace headway::pipeline {

/// Compares the camera's distances with those of wheel odometry, over pieces of 2 m.
///
/// A wrong baseline or focal length scales all depths and with them the map, which nothing in the
/// images shows. Wheels have errors of their own (pressure, slip), so that a difference is said and
/// not applied. The median over the pieces is robust against slip in less than half of them.
/// Compared are the chords of pieces that are about straight: the noise of many small steps adds up
/// to a path, but not to a chord.
class ScaleCheck {
 public:
  explicit ScaleCheck(const StereoCamera& camera) : camera_(camera) {}

  /// Takes the robot's motion since the previous frame; where one is unknown, a new piece begins.
  ///
  /// @return "odometry_scale" if the first piece differs by a factor of 3, and for each piece at
  ///         whose end the scales differ, surely, by more than 1 %. Fatal: "distance_unit" if the
  ///         first one differs so much that the unit of baseline or depths is wrong
  [[nodiscard]] Findings add(const std::optional<Pose>& by_camera,
                             const std::optional<Pose>& by_odometry, std::size_t frame);

  /// Distances were measured by another calibration until now.
  void restart() {
    piece_ = {};
    ratios_.clear();
  }

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
  [[nodiscard]] std::optional<Finding> checkUnit(std::size_t frame);

  StereoCamera camera_;
  bool is_unit_checked_ = false;
  Piece piece_;
  std::deque<double> ratios_;  ///< of the newest pieces
};

}  // namespace headway::pipeline
