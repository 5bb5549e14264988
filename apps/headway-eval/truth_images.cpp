// SPDX-License-Identifier: BSD-3-Clause
#include "truth_images.h"

#include <headway/core/error.h>

#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::app {
namespace {

namespace fs = std::filesystem;

constexpr double kDepthUnit = 256.0;  ///< KITTI depth maps: 256 units per metre
constexpr int kOutline_px = 2;        ///< width of a moving object's outline that its mask may miss

cv::Mat readImage(const fs::path& folder, std::size_t frame, const StereoCamera& camera) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.png", frame);
  const fs::path path = folder / name;
  cv::Mat image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  if (image.empty()) {
    throw InputError(path.string() + ": cannot be read; was headway-sim run with --depth --masks?");
  }
  if (image.size() != cv::Size(camera.width, camera.height)) {
    throw InputError(path.string() + ": the image size differs from the replay's rectified camera");
  }
  return image;
}

}  // namespace

cv::Mat readTrueDepth(const fs::path& folder, std::size_t frame, const StereoCamera& camera) {
  cv::Mat depth;
  readImage(folder / "depth", frame, camera).convertTo(depth, CV_32F, 1.0 / kDepthUnit);
  return depth;
}

cv::Mat readMovingMask(const fs::path& folder, std::size_t frame, const StereoCamera& camera) {
  constexpr int kSide = 2 * kOutline_px + 1;
  cv::Mat moving = readImage(folder / "masks", frame, camera);
  cv::dilate(moving, moving, cv::getStructuringElement(cv::MORPH_RECT, {kSide, kSide}));
  return moving;
}

}  // namespace headway::app
