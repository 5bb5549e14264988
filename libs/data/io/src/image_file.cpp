// SPDX-License-Identifier: BSD-3-Clause
#include <headway/io/image_decoding.h>
#include <headway/io/image_file.h>

#include <filesystem>
#include <fstream>
#include <opencv2/imgproc.hpp>

namespace headway::io {
namespace {

constexpr std::uintmax_t kMaxFileBytes = 1 << 28;  // of an image, more than any within the limits

/// The content of an image file; empty if it is missing or larger than any.
std::string imageBytesOf(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return {};
  const auto size = std::filesystem::file_size(path, error);
  if (error || size == 0 || size > kMaxFileBytes) return {};
  std::string bytes(static_cast<std::size_t>(size), '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  return file ? bytes : std::string();
}

}  // namespace

cv::Mat loadImage(const std::string& path) { return decodeImage(imageBytesOf(path)); }

cv::Mat loadGreyImage(const std::string& path) { return greyOf(loadImage(path)); }

cv::Mat loadDepthImage(const std::string& path) { return decodeDepthImage(imageBytesOf(path)); }

bool isDeepImageFile(const std::string& path) { return isDeepImage(imageBytesOf(path)); }

cv::Mat greyOf(const cv::Mat& image) {
  if (image.channels() == 1) return image;
  cv::Mat grey;
  cv::cvtColor(image, grey, cv::COLOR_BGR2GRAY);
  return grey;
}

}  // namespace headway::io
