// SPDX-License-Identifier: BSD-3-Clause
#include "image_conversion.h"

#include <headway/io/image_decoding.h>

#include <cmath>
#include <cstring>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

namespace headway::bags {
namespace {

constexpr int kNoConversion = -1;
constexpr float kMillimetresPerMetre = 1000.0F;
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
      const float depth = value * kMillimetresPerMetre;
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

}  // namespace headway::bags
