// SPDX-License-Identifier: BSD-3-Clause
// Decoding of the messages of ROS 1 and ROS 2.
#include "messages.h"

#include <cmath>

namespace headway::bags {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;  // before a message of CDR
constexpr std::size_t kMaxPadding = 7;          // of CDR after a message

constexpr double kMaxNormError = 0.1;  // of a quaternion

std::string withoutSlash(const std::string& frame) {
  return !frame.empty() && frame.front() == '/' ? frame.substr(1) : frame;
}

MessageHeader headerFrom(WireReader& in) {
  MessageHeader header;
  if (in.isRos1()) (void)in.number<std::uint32_t>();  // sequence number
  // Seconds are unsigned in ROS 1 and signed in ROS 2; both last until 2038 at least.
  const std::int64_t seconds = in.number<std::int32_t>();
  header.time_ns = seconds * 1000000000 + in.number<std::uint32_t>();
  header.frame = withoutSlash(in.text());
  return header;
}

Eigen::Vector3d vectorFrom(WireReader& in) {
  const auto values = in.array<double, 3>();
  return {values[0], values[1], values[2]};
}

Pose poseFrom(WireReader& in) {
  Pose pose = Pose::Identity();
  pose.translation() = vectorFrom(in);
  const auto q = in.array<double, 4>();
  const Eigen::Quaterniond rotation(q[3], q[0], q[1], q[2]);
  if (!pose.translation().allFinite() || !(std::abs(rotation.norm() - 1.0) < kMaxNormError)) {
    throw BrokenData("a pose is none: its rotation has no length of 1");
  }
  pose.linear() = rotation.normalized().toRotationMatrix();
  return pose;
}

/// The matrices for the part of the image that is sent: binned, or a region of interest.
void applyRegion(io::CameraInfo& info, WireReader& in) {
  const double binning_x = std::max(1U, in.number<std::uint32_t>());
  const double binning_y = std::max(1U, in.number<std::uint32_t>());
  const auto x = in.number<std::uint32_t>();
  const auto y = in.number<std::uint32_t>();
  const auto height = in.number<std::uint32_t>();
  const auto width = in.number<std::uint32_t>();
  (void)in.number<std::uint8_t>();  // whether to rectify the region
  const auto part = [](double value) { return static_cast<int>(std::min(value, 1e9)); };
  if (width > 0 && height > 0) {
    info.width = part(width);
    info.height = part(height);
    info.K[2] -= x;
    info.K[5] -= y;
    info.P[2] -= x;
    info.P[6] -= y;
  }
  info.width = part(info.width / binning_x);
  info.height = part(info.height / binning_y);
  for (std::size_t i = 0; i < 3; ++i) {
    info.K[i] /= binning_x;
    info.K[3 + i] /= binning_y;
  }
  for (std::size_t i = 0; i < 4; ++i) {
    info.P[i] /= binning_x;
    info.P[4 + i] /= binning_y;
  }
}

}  // namespace

WireReader::WireReader(std::string_view message, Encoding encoding) : bytes_(message) {
  if (encoding == Encoding::kOther) throw BrokenData("a message of an unknown encoding");
  if (encoding == Encoding::kRos1) return;
  if (bytes_.size() < kEncapsulationBytes) throw BrokenData("a message without encapsulation");
  const auto kind = static_cast<unsigned char>(bytes_[1]);
  const bool is_version1 = kind <= 1;               // CDR, big and little endian
  const bool is_version2 = kind == 6 || kind == 7;  // the same of PLAIN_CDR2
  if (bytes_[0] != 0 || (!is_version1 && !is_version2)) {
    throw BrokenData("a message of an unknown encapsulation");
  }
  is_big_endian_ = kind % 2 == 0;
  max_alignment_ = is_version1 ? 8 : 4;
  bytes_.remove_prefix(kEncapsulationBytes);
}

std::string WireReader::text() {
  std::string_view value = bytes();
  if (!isRos1() && !value.empty() && value.back() == '\0') value.remove_suffix(1);
  return std::string(value);
}

std::uint32_t WireReader::length(std::size_t min_bytes) {
  const auto count = number<std::uint32_t>();
  if (count > (bytes_.size() - at_) / min_bytes) {
    throw BrokenData("a sequence is longer than its message");
  }
  return count;
}

void WireReader::requireEnd() const {
  if (bytes_.size() - at_ > (isRos1() ? 0 : kMaxPadding)) {
    throw BrokenData("a message is longer than its type");
  }
}

void WireReader::align(std::size_t size) {
  const std::size_t alignment = std::min(size, max_alignment_);
  at_ = (at_ + alignment - 1) / alignment * alignment;
}

std::string_view WireReader::take(std::size_t count) {
  if (at_ > bytes_.size() || count > bytes_.size() - at_) {
    throw BrokenData("a message is shorter than its type");
  }
  const auto result = bytes_.substr(at_, count);
  at_ += count;
  return result;
}

MessageHeader decodeHeader(std::string_view content, Encoding encoding) {
  WireReader in(content, encoding);
  return headerFrom(in);
}

ImageMessage decodeImageMessage(std::string_view content, Encoding encoding) {
  WireReader in(content, encoding);
  ImageMessage image;
  image.header = headerFrom(in);
  image.height = in.number<std::uint32_t>();
  image.width = in.number<std::uint32_t>();
  image.encoding = in.text();
  image.is_big_endian = in.number<std::uint8_t>() != 0;
  image.step = in.number<std::uint32_t>();
  image.data = in.bytes();
  in.requireEnd();
  return image;
}

CompressedImageMessage decodeCompressedImage(std::string_view content, Encoding encoding) {
  WireReader in(content, encoding);
  CompressedImageMessage image;
  image.header = headerFrom(in);
  image.format = in.text();
  image.data = in.bytes();
  in.requireEnd();
  return image;
}

CameraInfoMessage decodeCameraInfo(std::string_view content, Encoding encoding) {
  WireReader in(content, encoding);
  CameraInfoMessage camera;
  camera.header = headerFrom(in);
  const auto height = in.number<std::uint32_t>();
  const auto width = in.number<std::uint32_t>();
  if (width > 1000000 || height > 1000000) throw BrokenData("a camera has an impossible size");
  camera.info.height = static_cast<int>(height);
  camera.info.width = static_cast<int>(width);
  camera.info.distortion_model = in.text();
  camera.info.D = in.numbers<double>();
  camera.info.K = in.array<double, 9>();
  camera.info.R = in.array<double, 9>();
  camera.info.P = in.array<double, 12>();
  applyRegion(camera.info, in);
  in.requireEnd();
  return camera;
}

ImuMessage decodeImu(std::string_view content, Encoding encoding) {
  constexpr double kNotMeasured = -1.0;  // in the first element of a covariance
  WireReader in(content, encoding);
  ImuMessage imu;
  imu.header = headerFrom(in);
  (void)in.array<double, 4 + 9>();  // orientation and its covariance
  imu.angular_velocity = vectorFrom(in);
  imu.has_angular_velocity = in.array<double, 9>()[0] != kNotMeasured;
  imu.acceleration = vectorFrom(in);
  // An accelerometer feels gravity.
  imu.has_acceleration = in.array<double, 9>()[0] != kNotMeasured && !imu.acceleration.isZero(0.0);
  in.requireEnd();
  return imu;
}

void leaveOutZeroRate(ImuMessage& imu) {
  imu.has_angular_velocity = imu.has_angular_velocity && !imu.angular_velocity.isZero(0.0);
}

bool isFinite(const ImuMessage& imu) {
  return (!imu.has_angular_velocity || imu.angular_velocity.allFinite()) &&
         (!imu.has_acceleration || imu.acceleration.allFinite());
}

OdometryMessage decodeOdometry(std::string_view content, Encoding encoding) {
  WireReader in(content, encoding);
  OdometryMessage odometry;
  odometry.header = headerFrom(in);
  odometry.child_frame = withoutSlash(in.text());
  odometry.T_odom_child = poseFrom(in);
  (void)in.array<double, 36 + 6 + 36>();  // covariance, velocities and their covariance
  in.requireEnd();
  return odometry;
}

LaserScanMessage decodeLaserScan(std::string_view content, Encoding encoding) {
  WireReader in(content, encoding);
  LaserScanMessage scan;
  scan.header = headerFrom(in);
  scan.angle_min = in.number<float>();
  scan.angle_max = in.number<float>();
  scan.angle_increment = in.number<float>();
  (void)in.array<float, 2>();  // time between beams and between scans
  scan.range_min = in.number<float>();
  scan.range_max = in.number<float>();
  scan.ranges = in.numbers<float>();
  (void)in.numbers<float>();  // intensities
  in.requireEnd();
  return scan;
}

NavSatFixMessage decodeNavSatFix(std::string_view content, Encoding encoding) {
  WireReader in(content, encoding);
  NavSatFixMessage fix;
  fix.header = headerFrom(in);
  fix.status = in.number<std::int8_t>();
  (void)in.number<std::uint16_t>();  // satellite systems
  fix.latitude_deg = in.number<double>();
  fix.longitude_deg = in.number<double>();
  fix.altitude_m = in.number<double>();
  const auto covariance = in.array<double, 9>();
  const bool is_known = in.number<std::uint8_t>() != 0;
  const double variance = 0.5 * (covariance[0] + covariance[4]);
  if (is_known && variance > 0.0 && std::isfinite(variance)) fix.sigma_m = std::sqrt(variance);
  in.requireEnd();
  return fix;
}

PoseMessage decodePose(std::string_view content, Encoding encoding) {
  WireReader in(content, encoding);
  PoseMessage message;
  message.header = headerFrom(in);
  message.pose = poseFrom(in);
  (void)in.array<double, 36>();  // covariance
  in.requireEnd();
  return message;
}

std::vector<TransformMessage> decodeTransforms(std::string_view content, Encoding encoding) {
  // Time, lengths of two names, pose: not much less than what is allocated for each.
  constexpr std::size_t kMinBytes = 4 * sizeof(std::uint32_t) + 7 * sizeof(double);
  WireReader in(content, encoding);
  std::vector<TransformMessage> transforms(in.length(kMinBytes));
  for (TransformMessage& transform : transforms) {
    transform.header = headerFrom(in);
    transform.child_frame = withoutSlash(in.text());
    transform.T_parent_child = poseFrom(in);
  }
  in.requireEnd();
  return transforms;
}

}  // namespace headway::bags
