// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_recording.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::io::test {
namespace {

constexpr int kBlock = 7;  // [px]

/// Cuts a pair out of a wide picture, so that both images are filled to their edges.
StereoImages cutPair(const cv::Mat& wide, int disparity, const cv::Size& size) {
  const int margin = (wide.cols - size.width) / 2;
  return {wide(cv::Rect(cv::Point(margin, 0), size)).clone(),
          wide(cv::Rect(cv::Point(margin + disparity, 0), size)).clone()};
}

}  // namespace

StereoCamera smallCamera() {
  StereoCamera camera;
  camera.width = 160;
  camera.height = 120;
  camera.fx = camera.fy = 100.0;
  camera.cx = 80.5;
  camera.cy = 60.25;
  camera.baseline_m = 0.2;
  camera.T_robot_cam.translation().z() = 1.0;
  return camera;
}

StereoImages wall(int number, int disparity, const cv::Size& size) {
  cv::RNG random(static_cast<std::uint64_t>(number) + 1);
  const cv::Size wide_size(size.width + 100, size.height);
  cv::Mat blocks(wide_size.height / kBlock + 1, wide_size.width / kBlock + 1, CV_8UC1);
  random.fill(blocks, cv::RNG::UNIFORM, 0, 256);
  cv::Mat wide;
  cv::resize(blocks, wide, {}, kBlock, kBlock, cv::INTER_NEAREST);
  return cutPair(wide(cv::Rect({0, 0}, wide_size)), disparity, size);
}

StereoImages colourWall(int number, int disparity) {
  std::vector<cv::Mat> left, right;
  for (int channel = 0; channel < 3; ++channel) {
    const auto [channel_left, channel_right] = wall(3 * number + channel, disparity);
    left.push_back(channel_left);
    right.push_back(channel_right);
  }
  StereoImages images;
  cv::merge(left, images.left);
  cv::merge(right, images.right);
  return images;
}

void recordWalls(const std::string& path, std::size_t frames, ImageStorage storage) {
  RawlogSink sink(path, storage);
  for (std::size_t i = 0; i < frames; ++i) {
    const auto [left, right] = wall(static_cast<int>(i));
    sink.writeStereo(frameTime(i), left, right, rawFrom(smallCamera()));
  }
  sink.close();
}

std::vector<RecordedFrame> framesOf(RawlogSource& source) {
  std::vector<RecordedFrame> frames;
  while (auto frame = source.next()) frames.push_back(std::move(*frame));
  return frames;
}

std::vector<RecordedFrame> framesOf(const std::string& path, const RawlogSourceOptions& options) {
  RawlogSource source(path, options);
  return framesOf(source);
}

bool sameImage(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void writeContent(const std::string& path, const std::string& content) {
  const auto folder = std::filesystem::path(path).parent_path();
  if (!folder.empty()) std::filesystem::create_directories(folder);
  std::ofstream(path, std::ios::binary) << content;
}

}  // namespace headway::io::test
