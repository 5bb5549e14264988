// SPDX-License-Identifier: BSD-3-Clause
#include "camera_check.h"

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
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

/// @return  whether both images contain structure
bool checkExposure(const StereoFrame& frame, Findings& findings) {
  bool has_structure = true;
  for (const auto& [image, side] :
       {std::pair(&frame.left, "left"), std::pair(&frame.right, "right")}) {
    if (image->empty()) continue;  // of a depth camera
    const Light light = lightOf(*image);
    if (light.contrast >= kMinContrast) continue;
    has_structure = false;
    if (light.grey < kDarkGrey) {
      findings.push_back(
          {"camera_dark", frame.index,
           std::string("the ") + side +
               " image is dark and without structure; check lens cover, exposure and light"});
      break;  // counted once a frame
    }
    if (light.grey > kBrightGrey) {
      findings.push_back(
          {"camera_bright", frame.index,
           std::string("the ") + side +
               " image is overexposed and without structure; check exposure and glare"});
      break;
    }
  }
  return has_structure;
}

constexpr double kMaxDarkGrey = 20.0;  // mean grey level of a frame that is lost for it
constexpr double kEvenContrast = 6.0;  // standard deviation of the grey levels
constexpr double kBlurredRatio = 0.5;  // of the usual sharpness
constexpr double kUnsharp = 0.06;      // without a usual sharpness
constexpr std::size_t kFewCorners = 150;
constexpr int kCornerThreshold = 12;      // of FAST, grey levels
constexpr int kMeasuredEvery = 10;        // tracked frames
constexpr double kSharpnessWeight = 0.1;  // of a new measurement

/// Contrast between neighbours in relation to that of the whole image: falls with blur, and hardly
/// depends on light.
double sharpnessOf(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  if (!(deviation[0] > 0.0)) return 0.0;
  cv::Mat edges;
  cv::Laplacian(image, edges, CV_16S);
  cv::Scalar edge_mean, edge_deviation;
  cv::meanStdDev(edges, edge_mean, edge_deviation);
  return edge_deviation[0] / deviation[0];
}

std::size_t cornersOf(const cv::Mat& image) {
  std::vector<cv::KeyPoint> corners;
  cv::FAST(image, corners, kCornerThreshold);
  return corners.size();
}

}  // namespace

void CameraCheck::addTracked(const StereoFrame& frame) {
  if (tracked_++ % kMeasuredEvery != 0) return;
  const double sharpness = sharpnessOf(frame.left);
  sharpness_ = sharpness_ ? *sharpness_ + kSharpnessWeight * (sharpness - *sharpness_) : sharpness;
}

Finding CameraCheck::lossOf(const StereoFrame& frame) const {
  const auto lost = [&](const char* name, const char* text) {
    return Finding{std::string("lost_") + name, frame.index,
                   std::string("the camera is lost: ") + text};
  };
  cv::Scalar mean, deviation;
  cv::meanStdDev(frame.left, mean, deviation);
  if (mean[0] < kMaxDarkGrey) {
    return lost("too_dark",
                "the image is too dark; lengthen the exposure or add light; slam.use_odometry and "
                "slam.use_imu bridge dark places");
  }
  if (deviation[0] < kEvenContrast) {
    return lost("covered",
                "the image is an even grey, as of a covered lens or a wall before it; check the "
                "lens; slam.use_odometry and slam.use_imu bridge short times");
  }
  if (sharpnessOf(frame.left) < (sharpness_ ? kBlurredRatio * *sharpness_ : kUnsharp)) {
    return lost("blurred",
                "the image is blurred; shorten the exposure or turn more slowly, and check the "
                "focus; slam.use_imu predicts turns");
  }
  if (cornersOf(frame.left) < kFewCorners) {
    return lost("few_features",
                "the image shows too few features, as of bare walls; more slam.features and wheel "
                "odometry (slam.use_odometry) help");
  }
  return lost("moved_too_fast",
              "the view differs too much from the one before; raise the frame rate, or let "
              "slam.use_imu and slam.use_odometry predict the motion");
}

Findings CameraCheck::add(const StereoFrame& frame) {
  Findings findings;
  const bool has_structure = checkExposure(frame, findings);
  is_frozen_ = has_structure && isSame(left_, frame.left) &&
               (frame.right.empty() || isSame(right_, frame.right));
  if (is_frozen_) {
    findings.push_back({"camera_frozen", frame.index,
                        "the camera delivers the same images again: the pose is unreliable unless "
                        "wheel odometry stands; check its cable and its driver"});
  }
  left_ = frame.left;
  right_ = frame.right;
  return findings;
}

}  // namespace headway::pipeline
