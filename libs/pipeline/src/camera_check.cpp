// SPDX-License-Identifier: BSD-3-Clause
#include <headway/pipeline/camera_check.h>

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

namespace headway::pipeline {
namespace {

constexpr int kRowStep = 16;           ///< distance of the compared rows [px]
constexpr double kDarkGrey = 16.0;     ///< mean grey level below which an image is dark
constexpr double kBrightGrey = 240.0;  ///< above which it is overexposed
constexpr double kMinContrast = 2.0;   ///< below, images without structure are alike in any case

bool isSame(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty() || a.size() != b.size() || a.data == b.data) return false;
  for (int row = 0; row < a.rows; row += kRowStep) {
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols)) != 0) return false;
  }
  return true;
}

struct Light {
  double grey = 0.0;      ///< mean grey level
  double contrast = 0.0;  ///< largest standard deviation of a row's grey levels
};

Light lightOf(const cv::Mat& image) {
  cv::Mat mean, deviation;
  Light light;
  const int rows = (image.rows + kRowStep - 1) / kRowStep;
  for (int row = 0; row < image.rows; row += kRowStep) {
    cv::meanStdDev(image.row(row), mean, deviation);
    light.grey += mean.at<double>(0) / rows;
    light.contrast = std::max(light.contrast, deviation.at<double>(0));
  }
  return light;
}

}  // namespace

bool CameraCheck::warnOfExposure(const StereoFrame& frame, Warnings& warnings) {
  bool has_structure = true;
  for (const auto& [image, side] :
       {std::pair(&frame.left, "left"), std::pair(&frame.right, "right")}) {
    if (image->empty()) continue;  // of a depth camera
    const Light light = lightOf(*image);
    if (light.contrast >= kMinContrast) continue;
    has_structure = false;
    if (light.grey < kDarkGrey) {
      addWarning("camera_dark", frame.index,
                 std::string("the ") + side +
                     " image is dark and without structure; check lens cover, exposure and light",
                 warnings);
      break;  // counted once a frame
    }
    if (light.grey > kBrightGrey) {
      addWarning("camera_bright", frame.index,
                 std::string("the ") + side +
                     " image is overexposed and without structure; check exposure and glare",
                 warnings);
      break;
    }
  }
  return has_structure;
}

bool CameraCheck::add(const StereoFrame& frame, Warnings& warnings) {
  const bool has_structure = warnOfExposure(frame, warnings);
  const bool is_frozen = has_structure && isSame(left_, frame.left) &&
                         (frame.right.empty() || isSame(right_, frame.right));
  if (is_frozen) {
    addWarning("camera_frozen", frame.index,
               "the camera delivers the same images again: the pose is unreliable unless wheel "
               "odometry stands; check its cable and its driver",
               warnings);
  }
  left_ = frame.left;
  right_ = frame.right;
  return is_frozen;
}

}  // namespace headway::pipeline
