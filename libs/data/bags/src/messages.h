// SPDX-License-Identifier: BSD-3-Clause
// Decoding of the messages of ROS 1 and ROS 2.
#pragma once

#include <headway/bags/bag_reader.h>
#include <headway/core/pose.h>
#include <headway/io/raw_camera.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "bag_file.h"

namespace headway::bags {

/// Reads the fields of a message in both of ROS' encodings, which differ in alignment, in the
/// terminating zero of strings, and in byte order.
///
/// Each length is checked against what is left before memory is allocated. Fast CDR and
/// roscpp_serialization resize to a length first.
class WireReader {
 public:
  /// @throws BrokenData if the encoding is not read
  WireReader(std::string_view message, Encoding encoding);

  [[nodiscard]] bool isRos1() const { return max_alignment_ == 1; }

  /// @throws BrokenData beyond the end, as all functions
  template <typename Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number>);
    align(sizeof(Number));
    std::array<char, sizeof(Number)> bytes;
    std::memcpy(bytes.data(), take(sizeof(Number)).data(), sizeof(Number));
    if (is_big_endian_) std::reverse(bytes.begin(), bytes.end());
    Number value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }
  std::string text();
  /// A sequence of bytes; valid as long as the message.
  std::string_view bytes() { return take(number<std::uint32_t>()); }
  /// The length of a sequence whose elements have at least `min_bytes`.
  std::uint32_t length(std::size_t min_bytes);

  template <typename Number>
  std::vector<Number> numbers() {
    std::vector<Number> values(length(sizeof(Number)));
    for (Number& value : values) value = number<Number>();
    return values;
  }
  template <typename Number, std::size_t kSize>
  std::array<Number, kSize> array() {
    std::array<Number, kSize> values;
    for (Number& value : values) value = number<Number>();
    return values;
  }

  /// @throws BrokenData if more is left than the padding of CDR: the message has another type
  void requireEnd() const;

 private:
  void align(std::size_t size);
  std::string_view take(std::size_t count);

  std::string_view bytes_;
  std::size_t at_ = 0;
  std::size_t max_alignment_ = 1;
  bool is_big_endian_ = false;
};

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

struct PoseMessage {
  MessageHeader header;
  Pose pose = Pose::Identity();
};

/// The header with which every message that is used begins.
[[nodiscard]] MessageHeader decodeHeader(std::string_view content, Encoding encoding);
[[nodiscard]] ImageMessage decodeImageMessage(std::string_view content, Encoding encoding);
[[nodiscard]] CompressedImageMessage decodeCompressedImage(std::string_view content,
                                                           Encoding encoding);
[[nodiscard]] CameraInfoMessage decodeCameraInfo(std::string_view content, Encoding encoding);
[[nodiscard]] ImuMessage decodeImu(std::string_view content, Encoding encoding);
/// Of a sensor with two topics: that of the accelerometer states a rate of zero (RealSense).
void leaveOutZeroRate(ImuMessage& imu);
/// Whether what was measured is made of numbers.
[[nodiscard]] bool isFinite(const ImuMessage& imu);
[[nodiscard]] OdometryMessage decodeOdometry(std::string_view content, Encoding encoding);
[[nodiscard]] LaserScanMessage decodeLaserScan(std::string_view content, Encoding encoding);
[[nodiscard]] NavSatFixMessage decodeNavSatFix(std::string_view content, Encoding encoding);
/// Of PoseWithCovarianceStamped.
[[nodiscard]] PoseMessage decodePose(std::string_view content, Encoding encoding);
[[nodiscard]] std::vector<TransformMessage> decodeTransforms(std::string_view content,
                                                             Encoding encoding);

}  // namespace headway::bags
