// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_reader.h>
#include <headway/core/pose.h>
#include <headway/io/camera_info.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace headway::bags {

// Messages of ROS 1 and ROS 2 alike, with the fields that are used. Each decode function throws
// BrokenData if the bytes are not those of its type. Views are valid as long as the message.

struct MessageHeader {
  std::int64_t time_ns = 0;  ///< 0: not set
  std::string frame;         ///< without a leading slash
};

struct ImageMessage {
  MessageHeader header;
  std::uint32_t height = 0;
  std::uint32_t width = 0;
  std::string encoding;  ///< "mono8", "16UC1", ...
  bool is_big_endian = false;
  std::uint32_t step = 0;  ///< bytes per row
  std::string_view data;
};

struct CompressedImageMessage {
  MessageHeader header;
  std::string format;
  std::string_view data;
};

struct CameraInfoMessage {
  MessageHeader header;
  io::CameraInfo info;  ///< of the images, with their binning and region of interest
};

struct ImuMessage {
  MessageHeader header;
  bool has_angular_velocity = false;
  bool has_acceleration = false;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      ///< [m/s^2]
};

struct OdometryMessage {
  MessageHeader header;
  std::string child_frame;
  Pose T_odom_child = Pose::Identity();
};

struct LaserScanMessage {
  MessageHeader header;
  float angle_min = 0.0F, angle_max = 0.0F, angle_increment = 0.0F;  ///< [rad]
  float range_min = 0.0F, range_max = 0.0F;                          ///< [m]
  std::vector<float> ranges;                                         ///< [m]
};

struct NavSatFixMessage {
  MessageHeader header;
  int status = 0;  ///< -1: no fix, 1 and 2: with corrections
  double latitude_deg = 0.0, longitude_deg = 0.0, altitude_m = 0.0;
  double sigma_m = 0.0;  ///< of each horizontal axis; 0: unknown
};

struct TransformMessage {
  MessageHeader header;  ///< its frame is the parent
  std::string child_frame;
  Pose T_parent_child = Pose::Identity();
};

/// The header with which every message that is used begins.
[[nodiscard]] MessageHeader decodeHeader(std::string_view content, Encoding encoding);
[[nodiscard]] ImageMessage decodeImageMessage(std::string_view content, Encoding encoding);
[[nodiscard]] CompressedImageMessage decodeCompressedImage(std::string_view content,
                                                           Encoding encoding);
[[nodiscard]] CameraInfoMessage decodeCameraInfo(std::string_view content, Encoding encoding);
[[nodiscard]] ImuMessage decodeImu(std::string_view content, Encoding encoding);
[[nodiscard]] OdometryMessage decodeOdometry(std::string_view content, Encoding encoding);
[[nodiscard]] LaserScanMessage decodeLaserScan(std::string_view content, Encoding encoding);
[[nodiscard]] NavSatFixMessage decodeNavSatFix(std::string_view content, Encoding encoding);
[[nodiscard]] std::vector<TransformMessage> decodeTransforms(std::string_view content,
                                                             Encoding encoding);

}  // namespace headway::bags
