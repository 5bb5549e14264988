// SPDX-License-Identifier: BSD-3-Clause
// Ends of laser beams as obstacles of a ground scan.
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/core/scan.h>
#include <headway/core/track.h>
#include <headway/pipeline/perception_params.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace headway::pipeline {

/// The ground as a plane in the robot's frame.
struct RobotGround {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< unit normal
  double robot_height = 0.0;                      ///< of the robot's origin above it [m]

  [[nodiscard]] double heightOf(const Eigen::Vector3d& point) const {
    return up.dot(point) + robot_height;
  }
};

/// What the beams of a frame's laser scans are compared with.
struct LaserScene {
  Time time = 0.0;                       ///< of the frame [s]
  Pose T_odom_robot;                     ///< in this frame
  std::optional<Pose> T_previous_robot;  ///< its motion since the previous frame
  double interval_s = 0.0;               ///< since that frame [s]
  RobotGround ground;
  Eigen::Vector3d camera = Eigen::Vector3d::Zero();  ///< robot frame [m]
  double min_obstacle_height_m = 0.12;
  double max_obstacle_height_m = 2.0;
  map::RobotFootprint footprint;
};

/// Enters the ends of a frame's laser beams as obstacles into its ground scan.
///
/// An end is an obstacle if it is higher above the ground than half the minimum height of an
/// obstacle (lower ends are ground, as for stereo) and not above the maximum; the ends on the
/// robot and on tracks that move, or may move, are left out. Free ground of stereo ends at the
/// nearest obstacle of a laser in its direction. Beams make no ground free, see GroundScan: a level
/// beam only shows that earlier obstacles of lasers have left. Scans are moved to the frame's time
/// with the robot's motion since the previous frame.
///
/// @param scans   of this frame, within half a frame interval
/// @param tracks  of this frame; their boxes are moved to the time of a scan
/// @param counts  scans "used", and ends of beams: "obstacles", "on_moving_objects", "on_ground",
///                "above_robot", "on_robot", "beyond_reach"
void addLaserScans(const std::vector<LaserScan>& scans, const LaserScene& scene,
                   const std::vector<Track>& tracks, const LaserParams& params, GroundScan& scan,
                   std::map<std::string, std::size_t>& counts);

}  // namespace headway::pipeline
