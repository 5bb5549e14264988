// SPDX-License-Identifier: BSD-3-Clause
// How rich the images of stereo rawlogs are, and how well their disparity can be measured.
//   bench_images RAWLOG...
// Prints a row for each: FAST corners a frame, contrast, matches of OpenCV's SGBM, and, where true
// depth lies in NAME.truth/depth (headway-sim --depth), the share of matches off by more than 3 px.
#include <headway/io/rawlog_source.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <opencv2/calib3d.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace {

using namespace headway;

constexpr int kEvery = 10;  // frames: neighbouring ones are similar
constexpr int kDisparities = 128;
constexpr int kBlock = 5;
constexpr double kBad = 3.0;  // [px]

struct Disparities {
  std::size_t pixels = 0;  ///< where a match can be
  std::size_t matched = 0;
  std::size_t judged = 0;  ///< matched, with true depth
  std::size_t bad = 0;
};

cv::Mat matched(const StereoFrame& frame) {
  const int penalty = kBlock * kBlock;
  const auto matcher =
      cv::StereoSGBM::create(0, kDisparities, kBlock, 8 * penalty, 32 * penalty, 1, 63, 10, 100, 2);
  cv::Mat disparity;
  matcher->compute(frame.left, frame.right, disparity);
  return disparity;
}

void count(const StereoFrame& frame, const cv::Mat& depth, Disparities& all) {
  const cv::Mat disparity = matched(frame);
  const double fb = frame.camera->fx * frame.camera->baseline_m;
  for (int v = 0; v < disparity.rows; ++v) {
    for (int u = kDisparities; u < disparity.cols; ++u) {
      ++all.pixels;
      const double found = disparity.at<std::int16_t>(v, u) / 16.0;
      if (found <= 0.0) continue;
      ++all.matched;
      const double z = depth.empty() ? 0.0 : depth.at<std::uint16_t>(v, u) / 256.0;
      if (z <= 0.0) continue;
      ++all.judged;
      if (std::abs(found - fb / z) > kBad) ++all.bad;
    }
  }
}

cv::Mat trueDepth(const std::string& rawlog, std::size_t frame) {
  char name[32];
  std::snprintf(name, sizeof name, "depth/%06zu.png", frame);
  const auto folder = std::filesystem::path(rawlog).replace_extension(".truth");
  const auto file = folder / name;
  if (!std::filesystem::exists(file)) return {};
  return cv::imread(file.string(), cv::IMREAD_UNCHANGED);
}

double percent(std::size_t part, std::size_t whole) {
  return whole > 0 ? 100.0 * static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

void report(const std::string& rawlog) {
  io::RawlogSource source(rawlog, {});
  std::vector<double> corners, contrast;
  Disparities disparities;
  for (int i = 0; const auto frame = source.next(); ++i) {
    if (i % kEvery != 0 || !frame->stereo) continue;
    std::vector<cv::KeyPoint> found;
    cv::FAST(frame->stereo->left, found, 20);
    corners.push_back(static_cast<double>(found.size()));
    cv::Mat edges;
    cv::Sobel(frame->stereo->left, edges, CV_32F, 1, 0);
    contrast.push_back(cv::mean(cv::abs(edges))[0]);
    count(*frame->stereo, trueDepth(rawlog, frame->stereo->index), disparities);
  }
  if (corners.empty()) {
    std::printf("| %s | no stereo frames |\n", rawlog.c_str());
    return;
  }
  const auto median = [](std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + static_cast<long>(values.size() / 2),
                     values.end());
    return values[values.size() / 2];
  };
  char bad[32] = "—";
  if (disparities.judged > 0) {
    std::snprintf(bad, sizeof bad, "%.2f", percent(disparities.bad, disparities.judged));
  }
  std::printf("| %s | %.0f | %.1f | %.1f | %s |\n",
              std::filesystem::path(rawlog).stem().string().c_str(), median(corners),
              median(contrast), percent(disparities.matched, disparities.pixels), bad);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf(
      "| recording | FAST corners | mean horizontal Sobel | SGBM matches %% | bad-3 %% |\n");
  std::printf("| --- | --- | --- | --- | --- |\n");
  for (int i = 1; i < argc; ++i) report(argv[i]);
  return argc > 1 ? 0 : 2;
}
