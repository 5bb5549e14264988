// SPDX-License-Identifier: BSD-3-Clause
// Which topics of ROS 2 are read and published, in which frames and how often.
#include <headway/ros2/ros2_params.h>

namespace headway::ros2 {

void Ros2SourceParams::describe(Params::Section all) {
  auto section = all.user();
  section.add("left", left, "Images of the left camera; empty: guessed, as all topics");
  section.add("right", right, "Images of the right camera");
  section.add("color", color, "Colour images of a depth camera");
  section.add("depth", depth, "Depth images of a depth camera");
  section.add("imu", imu, "Inertial samples, up to two topics with a comma; none: none");
  section.add("odometry", odometry, "Wheel odometry; none: none");
  section.add("scan", scan, "Laser scans, separated by commas; none: none");
  section.add("gnss", gnss, "Satellite positions; none: none");
  section.add("base_frame", base_frame,
              "Frame of the robot; empty: base_link, base_footprint, base or body");
}

void Ros2SinkParams::describe(Params::Section all) {
  auto section = all.user();
  const auto rate = [&](const char* key, double& field, const char* meaning) {
    section.add(key, field, 0.0, 1000.0, "Hz", meaning);
  };
  section.add("prefix", prefix, "Of the topics without a name in ROS");
  section.add("map_frame", map_frame, "Frame of the map");
  section.add("odom_frame", odom_frame, "Frame of the odometry");
  section.add("map_odom", map_odom, "Publish /tf map -> odom");
  section.add("odom_base", odom_base,
              "Publish /tf odom -> base_link by the images; only if nothing else does");
  rate("odometry_hz", odometry_hz, "Odometry between frames, by wheels or gyroscope");
  rate("map_hz", map_hz, "/map");
  rate("local_costmap_hz", local_costmap_hz, "What is blocked and free now, as a grid");
  rate("obstacles_hz", obstacles_hz, "What is blocked now, as points");
  rate("dense_map_hz", dense_map_hz, "Dense coloured map");
  rate("tracks_hz", tracks_hz, "Detection3DArray and ObstacleArray");
  rate("predicted_hz", predicted_hz, "Grids of moving objects in 0.5 to 3 s");
  rate("markers_hz", markers_hz, "MarkerArray");
  rate("diagnostics_hz", diagnostics_hz, "/diagnostics");
  section.add("clock", clock, "Publish /clock by the times of the observations");
}

}  // namespace headway::ros2
