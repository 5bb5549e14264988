// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::test {}

namespace headway::io::test {

using namespace headway::test;

/// 160 x 120 px, f 100 px, baseline 0.2 m, 1 m above the robot's origin.
[[nodiscard]] StereoCamera smallCamera();

/// A wall of random blocks seen by a rectified pair: the right image is the left one moved by
/// `disparity` pixels. The same number gives the same picture.
struct StereoImages {
  cv::Mat left;
  cv::Mat right;
};
[[nodiscard]] StereoImages wall(int number, int disparity = 8, const cv::Size& size = {160, 120});
[[nodiscard]] StereoImages colourWall(int number, int disparity = 8);

/// Times of a 10 Hz recording.
[[nodiscard]] inline Time frameTime(std::size_t i) { return 100.0 + 0.1 * static_cast<double>(i); }

/// A rawlog of `frames` walls at frameTime(), wall(i) in frame i.
void recordWalls(const std::string& path, std::size_t frames,
                 ImageStorage storage = ImageStorage::kEmbedded);

/// All frames of a rawlog.
[[nodiscard]] std::vector<RecordedFrame> framesOf(RawlogSource& source);
[[nodiscard]] std::vector<RecordedFrame> framesOf(const std::string& path,
                                                  const RawlogSourceOptions& options = {});

/// Message of an InputError; "no error" if there is none.
template <typename Action>
[[nodiscard]] std::string errorOf(const Action& action);

/// Whether two images have the same size, type and pixels.
[[nodiscard]] bool sameImage(const cv::Mat& a, const cv::Mat& b);

/// A file's content, and the way back, which makes the folders that it is in.
[[nodiscard]] std::string contentOf(const std::string& path);
void writeContent(const std::string& path, const std::string& content);

}  // namespace headway::io::test

#include <headway/core/error.h>

template <typename Action>
std::string headway::io::test::errorOf(const Action& action) {
  try {
    action();
  } catch (const headway::InputError& error) {
    return error.what();
  }
  return "no error";
}
