// SPDX-License-Identifier: BSD-3-Clause
// Results as serialised messages of ROS 2.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/track.h>
#include <headway/ros2/topic_sink.h>
#include <mrpt/maps/CColouredPointsMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <cstdint>
#include <string>
#include <vector>

#include "messages.h"

namespace headway::ros2 {

using bags::MessageHeader;

[[nodiscard]] MessageHeader headerOf(Time time, const std::string& frame);

struct OdometrySample {
  Time time = 0.0;
  std::string frame;
  std::string child;
  Pose T_odom_robot = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Zero();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();          ///< robot's axes [m/s]
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< robot's axes [rad/s]
};

/// Cells row by row from the corner on: 0 free to 100 occupied, -1 unknown.
struct GridMessage {
  MessageHeader header;
  double cell_m = 0.0;
  std::uint32_t width = 0, height = 0;               ///< cells
  Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< of the first cell [m]
  std::vector<std::int8_t> cells;
};

[[nodiscard]] std::string clockMessage(Time time);  ///< rosgraph_msgs/Clock
/// tf2_msgs/TFMessage
[[nodiscard]] std::string transformMessage(const std::vector<bags::TransformMessage>& transforms);
[[nodiscard]] std::string odometryMessage(const OdometrySample& sample);  ///< nav_msgs/Odometry
[[nodiscard]] std::string gridMessage(const GridMessage& grid);  ///< nav_msgs/OccupancyGrid
/// The same of a static grid, with map_server's thresholds of free and occupied.
[[nodiscard]] std::string gridMessage(const MessageHeader& header,
                                      const mrpt::maps::COccupancyGridMap2D& grid);
/// sensor_msgs/PointCloud2 with x, y, z
[[nodiscard]] std::string cloudMessage(const MessageHeader& header,
                                       const std::vector<Eigen::Vector3f>& points);
/// sensor_msgs/PointCloud2 with x, y, z, rgb
[[nodiscard]] std::string cloudMessage(const MessageHeader& header,
                                       const mrpt::maps::CColouredPointsMap& points);
/// vision_msgs/Detection3DArray of the tracks that are shown
[[nodiscard]] std::string detectionMessage(const MessageHeader& header,
                                           const std::vector<Track>& tracks);
/// nav2_dynamic_msgs/ObstacleArray of the same
[[nodiscard]] std::string obstacleMessage(const MessageHeader& header,
                                          const std::vector<Track>& tracks);
/// visualization_msgs/MarkerArray: boxes, names and predicted paths
[[nodiscard]] std::string markerMessage(const MessageHeader& header,
                                        const std::vector<Track>& tracks);
/// diagnostic_msgs/DiagnosticArray
[[nodiscard]] std::string diagnosticMessage(Time time, const std::vector<DiagnosticLine>& lines);

}  // namespace headway::ros2
