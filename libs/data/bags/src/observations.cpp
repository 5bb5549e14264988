// SPDX-License-Identifier: BSD-3-Clause
// Messages of ROS as images and observations of MRPT.
#include "observations.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/gnss_fix.h>
#include <headway/io/image_file.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/raw_camera.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace headway::bags {
namespace {

constexpr int kNoConversion = -1;
constexpr std::size_t kDepthHeaderBytes = 12;  // of compressedDepth: format and two floats

struct PixelFormat {
  int type = CV_8UC1;
  int conversion = kNoConversion;  ///< of cv::cvtColor to BGR
};

/// Encodings of 8 bits. ROS names a Bayer pattern by its first row, OpenCV by its second.
const std::map<std::string, PixelFormat>& pixelFormats() {
  static const std::map<std::string, PixelFormat> formats = {
      {"mono8", {CV_8UC1}},
      {"8UC1", {CV_8UC1}},
      {"bgr8", {CV_8UC3}},
      {"8UC3", {CV_8UC3}},
      {"rgb8", {CV_8UC3, cv::COLOR_RGB2BGR}},
      {"bgra8", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"8UC4", {CV_8UC4, cv::COLOR_BGRA2BGR}},
      {"rgba8", {CV_8UC4, cv::COLOR_RGBA2BGR}},
      {"bayer_rggb8", {CV_8UC1, cv::COLOR_BayerBG2BGR}},
      {"bayer_bggr8", {CV_8UC1, cv::COLOR_BayerRG2BGR}},
      {"bayer_gbrg8", {CV_8UC1, cv::COLOR_BayerGR2BGR}},
      {"bayer_grbg8", {CV_8UC1, cv::COLOR_BayerGB2BGR}},
      {"yuv422", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"uyvy", {CV_8UC2, cv::COLOR_YUV2BGR_UYVY}},
      {"yuv422_yuy2", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}},
      {"yuyv", {CV_8UC2, cv::COLOR_YUV2BGR_YUY2}}};
  return formats;
}

/// The message's pixels, not copied; nullopt if its numbers do not fit each other.
std::optional<cv::Mat> pixelsIn(const ImageMessage& message, int type) {
  const std::uint64_t width = message.width, height = message.height, step = message.step;
  const bool has_size = width > 0 && height > 0 && width <= io::kMaxImageSide &&
                        height <= io::kMaxImageSide && width * height <= io::kMaxImagePixels;
  if (!has_size || step < width * CV_ELEM_SIZE(type) || step % CV_ELEM_SIZE1(type) != 0 ||
      message.data.size() < step * height) {
    return std::nullopt;
  }
  return cv::Mat(static_cast<int>(height), static_cast<int>(width), type,
                 const_cast<char*>(message.data.data()), static_cast<std::size_t>(step));
}

cv::Mat millimetresFrom(const cv::Mat& metres) {
  cv::Mat result(metres.size(), CV_16UC1, cv::Scalar(0));
  for (int row = 0; row < metres.rows; ++row) {
    for (int column = 0; column < metres.cols; ++column) {
      float value = 0.0F;  // not aligned in a message
      std::memcpy(&value, metres.ptr(row) + sizeof value * static_cast<std::size_t>(column),
                  sizeof value);
      const float depth = value * 1000.0F;
      if (depth >= 0.5F && depth < 65535.0F) {
        result.at<std::uint16_t>(row, column) = static_cast<std::uint16_t>(std::lround(depth));
      }
    }
  }
  return result;
}

std::uint32_t reversedBytes(std::uint32_t value) {
  return (value >> 24) | ((value >> 8) & 0xFF00U) | ((value << 8) & 0xFF0000U) | (value << 24);
}

/// Pixels with their bytes in the order of this machine.
cv::Mat inNativeOrder(const cv::Mat& pixels, bool is_big_endian) {
  cv::Mat result = pixels.clone();
  if (!is_big_endian) return result;
  for (int row = 0; row < result.rows; ++row) {
    for (int column = 0; column < result.cols; ++column) {
      if (result.depth() == CV_16U) {
        auto& value = result.at<std::uint16_t>(row, column);
        value = static_cast<std::uint16_t>((value >> 8) | (value << 8));
      } else {
        auto& value = result.at<std::uint32_t>(row, column);
        value = reversedBytes(value);
      }
    }
  }
  return result;
}

/// Depth of values that compressedDepth stores as inverse depth: a / (value - b) metres.
cv::Mat fromInverseDepth(const cv::Mat& values, float a, float b) {
  cv::Mat metres(values.size(), CV_32FC1, cv::Scalar(0));
  for (int row = 0; row < values.rows; ++row) {
    for (int column = 0; column < values.cols; ++column) {
      const auto value = values.at<std::uint16_t>(row, column);
      if (value > 0) metres.at<float>(row, column) = a / (static_cast<float>(value) - b);
    }
  }
  return millimetresFrom(metres);
}

constexpr double kScanSigmaM = 0.01;       // LaserScan states none; MRPT's default
constexpr std::size_t kMaxBeams = 100000;  // of a scan; lasers have some thousand

/// NMEA's quality of a fix of NavSatStatus: none, plain, satellite-based, ground-based corrections.
std::uint8_t qualityOf(int status) {
  if (status < 0) return 0;
  if (status == 0) return 1;
  return status == 1 ? 2 : 4;
}

}  // namespace

ConvertedImage pictureFrom(const ImageMessage& message) {
  const auto format = pixelFormats().find(message.encoding);
  if (format == pixelFormats().end()) return "image_encoding_" + message.encoding;
  const auto pixels = pixelsIn(message, format->second.type);
  if (!pixels) return std::string("broken_image");
  if (format->second.conversion == kNoConversion) return pixels->clone();
  try {
    cv::Mat result;
    cv::cvtColor(*pixels, result, format->second.conversion);
    return result;
  } catch (const cv::Exception&) {
    return std::string("broken_image");  // such as an odd number of columns of YUV
  }
}

ConvertedImage pictureFrom(const CompressedImageMessage& message) {
  cv::Mat image = io::decodeImage(message.data);
  if (image.empty()) return std::string("broken_image");
  return image;
}

ConvertedImage depthFrom(const ImageMessage& message) {
  const bool is_float = message.encoding == "32FC1";
  if (!is_float && message.encoding != "16UC1" && message.encoding != "mono16") {
    return "depth_encoding_" + message.encoding;
  }
  const auto pixels = pixelsIn(message, is_float ? CV_32FC1 : CV_16UC1);
  if (!pixels) return std::string("broken_image");
  const cv::Mat native = inNativeOrder(*pixels, message.is_big_endian);
  return is_float ? millimetresFrom(native) : native;
}

ConvertedImage depthFrom(const CompressedImageMessage& message) {
  if (message.data.size() < kDepthHeaderBytes) return std::string("broken_image");
  const bool has_header = message.format.find("compressedDepth") != std::string::npos;
  const cv::Mat values =
      io::decodeDepthImage(message.data.substr(has_header ? kDepthHeaderBytes : 0));
  if (values.empty()) return std::string("broken_image");
  if (message.format.rfind("32FC1", 0) != 0) return values;
  std::array<float, 2> parameters{};
  std::memcpy(parameters.data(), message.data.data() + sizeof(std::int32_t), sizeof parameters);
  return fromInverseDepth(values, parameters[0], parameters[1]);
}

ConvertedImage convertImage(const BagTopic& topic, std::string_view message, bool is_depth,
                            MessageHeader& header) {
  if (topic.type == "sensor_msgs/CompressedImage") {
    const auto image = decodeCompressedImage(message, topic.encoding);
    header = image.header;
    return is_depth ? depthFrom(image) : pictureFrom(image);
  }
  const auto image = decodeImageMessage(message, topic.encoding);
  header = image.header;
  return is_depth ? depthFrom(image) : pictureFrom(image);
}

mrpt::obs::CObservationIMU::Ptr imuObservation(const ImuMessage& message, Time time,
                                               const Pose& T_robot_imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  auto observation = CObservationIMU::Create();
  observation->timestamp = io::mrptTime(time);
  observation->sensorLabel = "imu";
  const Eigen::Vector3d rate = T_robot_imu.linear() * message.angular_velocity;
  const Eigen::Vector3d acceleration = T_robot_imu.linear() * message.acceleration;
  if (message.has_angular_velocity) {
    observation->set(IMU_WX, rate.x());
    observation->set(IMU_WY, rate.y());
    observation->set(IMU_WZ, rate.z());
  }
  if (message.has_acceleration) {
    observation->set(IMU_X_ACC, acceleration.x());
    observation->set(IMU_Y_ACC, acceleration.y());
    observation->set(IMU_Z_ACC, acceleration.z());
  }
  return observation;
}

mrpt::obs::CObservationGPS::Ptr gnssObservation(const NavSatFixMessage& message, Time time,
                                                const Pose& T_robot_antenna) {
  auto observation = mrpt::obs::CObservationGPS::Create();
  observation->timestamp = io::mrptTime(time);
  observation->sensorLabel = "gnss";
  observation->sensorPose = toMrpt(T_robot_antenna);
  mrpt::obs::gnss::Message_NMEA_GGA position;
  position.fields.latitude_degrees = message.latitude_deg;
  position.fields.longitude_degrees = message.longitude_deg;
  position.fields.altitude_meters = message.altitude_m;
  std::uint8_t quality = qualityOf(message.status);
  // Some drivers give the best status to what their covariance calls bad.
  if (quality > 1 && !io::gnssSigma(quality, io::hdopOf(quality, message.sigma_m))) quality = 1;
  position.fields.fix_quality = quality;
  if (const auto hdop = io::hdopOf(quality, message.sigma_m); hdop > 0.0) {
    position.fields.thereis_HDOP = true;
    position.fields.HDOP = static_cast<float>(*hdop);
  }
  observation->setMsg(position);
  return observation;
}

std::optional<io::RecordedScan> scanFrom(const LaserScanMessage& message, Time time,
                                         const Pose& T_robot_laser) {
  const double step = message.angle_increment;
  const auto beams = message.ranges.size();
  if (beams < 2 || beams > kMaxBeams || !std::isfinite(message.angle_min) || !std::isfinite(step) ||
      step == 0.0 || !(message.range_max > 0.0F)) {
    return std::nullopt;
  }
  const double aperture = std::abs(step) * static_cast<double>(beams - 1);
  if (aperture > 2.1 * M_PI) return std::nullopt;
  io::RecordedScan scan;
  scan.time = time;
  scan.aperture_rad = aperture;
  scan.max_range_m = message.range_max;
  scan.sigma_m = kScanSigmaM;
  for (const float range : message.ranges) {
    const bool is_measured = range >= message.range_min && range <= message.range_max;
    scan.ranges.push_back(is_measured ? range : 0.0F);
  }
  if (step < 0.0) std::reverse(scan.ranges.begin(), scan.ranges.end());
  const double middle = message.angle_min + 0.5 * step * static_cast<double>(beams - 1);
  scan.T_robot_laser = T_robot_laser * Eigen::AngleAxisd(middle, Eigen::Vector3d::UnitZ());
  return scan;
}

mrpt::obs::CObservation3DRangeScan::Ptr depthObservation(const cv::Mat& picture,
                                                         const cv::Mat& depth, Time time,
                                                         const BagRig& rig) {
  io::RawDepthCamera camera;
  camera.color = rig.color;
  camera.depth = rig.depth;
  camera.T_robot_color = rig.T_robot_color;
  camera.T_color_depth = rig.T_robot_color.inverse() * rig.T_robot_depth;
  auto observation =
      io::depthObservation(mrpt::img::CImage(picture, mrpt::img::SHALLOW_COPY), depth, camera);
  observation->timestamp = io::mrptTime(time);
  observation->sensorLabel = "rgbd";
  return observation;
}

}  // namespace headway::bags
