// SPDX-License-Identifier: BSD-3-Clause
// Which topics of ROS 2 are read and published, in which frames and how often.
#pragma once

#include <headway/core/params.h>

#include <string>

namespace headway::ros2 {

/// Topics to read. Section [ros2]; empty names are guessed from what is published, "none" is none.
struct Ros2SourceParams {
  std::string left, right;   ///< stereo camera
  std::string color, depth;  ///< depth camera
  std::string imu, odometry, scan, gnss;
  std::string base_frame;  ///< of the robot; empty: base_link, base_footprint, ...

  void describe(Params::Section section);
};

/// What is published. Section [ros2_publish]; rates are at most those of the frames, 0: never.
struct Ros2SinkParams {
  std::string prefix = "/headway";  ///< of the topics that have no name in ROS
  std::string map_frame = "map";
  std::string odom_frame = "odom";
  bool map_odom = true;       ///< /tf map -> odom
  bool odom_base = false;     ///< /tf odom -> base_link, by the images, if the robot has no other
  double odometry_hz = 60.0;  ///< wheels at 30 to 66 Hz are all passed on
  double map_hz = 1.0;
  double local_costmap_hz = 5.0;
  double obstacles_hz = 30.0;
  double dense_map_hz = 0.5;
  double tracks_hz = 30.0;
  double predicted_hz = 5.0;
  double markers_hz = 10.0;
  double diagnostics_hz = 1.0;
  bool clock = false;  ///< /clock by the times of the observations, for recordings

  void describe(Params::Section section);
};

}  // namespace headway::ros2
