// SPDX-License-Identifier: BSD-3-Clause
// Images of a truth folder.
#include "truth_images.h"

#include <headway/core/error.h>
#include <headway/io/image_file.h>

#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace headway::eval {
namespace {

namespace fs = std::filesystem;

/// The image of a frame, read by `load`. @throws InputError
template <typename Load>
cv::Mat readImage(const fs::path& folder, std::size_t frame, const StereoCamera& camera,
                  Load load) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.png", frame);
  const fs::path path = folder / name;
  cv::Mat image = load(path.string());
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
  readImage(folder / "depth", frame, camera, io::loadDepthImage)
      .convertTo(depth, CV_32F, 1.0 / 256.0);  // KITTI: 256 units a metre
  return depth;
}

cv::Mat readMovingMask(const fs::path& folder, std::size_t frame, const StereoCamera& camera) {
  constexpr int kSide = 5;  // widens by two pixels, the outline that a mask may miss
  cv::Mat moving = readImage(folder / "masks", frame, camera, io::loadGreyImage);
  cv::dilate(moving, moving, cv::getStructuringElement(cv::MORPH_RECT, {kSide, kSide}));
  return moving;
}

}  // namespace headway::eval
