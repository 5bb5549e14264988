// SPDX-License-Identifier: BSD-3-Clause
// Checks of each image: light, the same one again, one of the two without use, and why the camera
// is lost.
#include "camera_check.h"

#include <headway/core/text.h>
#include <headway/stereo/edge_width.h>

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <string>
#include <utility>

namespace headway::pipeline {
namespace {

/// Limits of an image that can be used.
struct ImageLimits {
  int row_step = 16;           ///< distance of the compared rows [px]
  double dark_grey = 16.0;     ///< mean grey level below which an image is dark
  double bright_grey = 240.0;  ///< above which it is overexposed
  double min_contrast = 2.0;   ///< standard deviation; below, images are alike in any case
};

/// Limits of an image in which the camera was lost, by reason.
struct LossLimits {
  double dark_grey = 20.0;     ///< mean grey level
  double even_contrast = 6.0;  ///< standard deviation of the grey levels
  /// Width of edges to that of the sharpest ones. Kinect at 100 to 170 deg/s: 1.8 to 2.1; tracked
  /// frames of EuRoC up to 1.5.
  double blurred_ratio = 1.6;
  double few_landmarks = 0.5;  ///< of the usual ones
  std::size_t few_corners = 150;
  int corner_threshold = 12;  ///< of FAST [grey levels], as SLAM searches poor images
};

constexpr ImageLimits kImage;
constexpr LossLimits kLoss;
constexpr double kSharpEdge_px =
    2.6;  ///< the least of real lenses (KITTI), as stereo::edgeWidths()
constexpr double kUnknownEdge_px = 4.0;    ///< of a soft lens, before any was measured
constexpr double kOtherLight_s = 60.0;     ///< in which dusk or focus make other edges usual
constexpr double kUsualLandmarks_s = 1.0;  ///< over which they are averaged

bool isSame(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty() || a.size() != b.size()) return false;
  for (int row = 0; row < a.rows; row += kImage.row_step) {
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
  const int rows = (image.rows + kImage.row_step - 1) / kImage.row_step;
  for (int row = 0; row < image.rows; row += kImage.row_step) {
    cv::meanStdDev(image.row(row), mean, deviation);
    light.grey += mean.at<double>(0) / rows;
    light.contrast = std::max(light.contrast, deviation.at<double>(0));
  }
  return light;
}

/// @return  whether left and right image contain structure
std::array<bool, 2> checkExposure(const StereoFrame& frame, Findings& findings) {
  std::array<bool, 2> has_structure = {true, true};
  bool is_said = false;
  for (std::size_t side = 0; side < 2; ++side) {
    const cv::Mat& image = side == 0 ? frame.left : frame.right;
    if (image.empty()) continue;  // of a depth camera
    const Light light = lightOf(image);
    if (light.contrast >= kImage.min_contrast) continue;
    has_structure[side] = false;
    const bool is_dark = light.grey < kImage.dark_grey;
    const bool is_bright = light.grey > kImage.bright_grey;
    if (is_said || (!is_dark && !is_bright)) continue;  // counted once a frame
    is_said = true;
    findings.push_back(
        {is_dark ? "camera_dark" : "camera_bright", frame.index,
         std::string("the ") + (side == 0 ? "left" : "right") +
             (is_dark ? " image is dark and without structure; check lens cover, exposure and light"
                      : " image is overexposed and without structure; check exposure and glare")});
  }
  return has_structure;
}

std::size_t cornersOf(const cv::Mat& image) {
  std::vector<cv::KeyPoint> corners;
  cv::FAST(image, corners, kLoss.corner_threshold);
  return corners.size();
}

}  // namespace

CameraCheck::CameraCheck() : sharpest_{kUnknownEdge_px, kUnknownEdge_px} {}

std::string CameraCheck::blurOf(const std::array<double, 2>& widths) const {
  const bool is_along_columns = widths[1] / sharpest_[1] > widths[0] / sharpest_[0];
  const double width = widths[is_along_columns ? 1 : 0];
  const double usual = sharpest_[is_along_columns ? 1 : 0];
  if (width < kLoss.blurred_ratio * usual) return "";
  return formatted("the image is blurred (edges %.1f times as wide as usual)", width / usual);
}

std::optional<Finding> CameraCheck::addTracked(const StereoFrame& frame, int landmarks) {
  const auto widths = stereo::edgeWidths(frame.left);
  const double seconds = std::max(0.0, frame.time - measured_.value_or(frame.time));
  measured_ = frame.time;
  const std::string blur = blurOf(widths);
  for (std::size_t i = 0; i < 2; ++i) {
    const double width = std::max(widths[i], kSharpEdge_px);
    const double weight = width < sharpest_[i] ? 1.0 : std::min(1.0, seconds / kOtherLight_s);
    sharpest_[i] += weight * (width - sharpest_[i]);
  }
  if (blur.empty()) {
    const double weight = std::min(1.0, seconds / kUsualLandmarks_s);
    landmarks_ = landmarks_ ? *landmarks_ + weight * (landmarks - *landmarks_) : landmarks;
  } else if (landmarks_ && landmarks < kLoss.few_landmarks * *landmarks_) {
    return Finding{"blurred", frame.index,
                   blur + formatted(", so that %d landmarks are tracked where %.0f are usual; "
                                    "shorten the exposure or turn more slowly",
                                    landmarks, *landmarks_)};
  }
  return std::nullopt;
}

Finding CameraCheck::lossOf(const StereoFrame& frame) const {
  const auto lost = [&](const char* name, const std::string& text) {
    return Finding{std::string("lost_") + name, frame.index, "the camera is lost: " + text};
  };
  cv::Scalar mean, deviation;
  cv::meanStdDev(frame.left, mean, deviation);
  if (mean[0] < kLoss.dark_grey) {
    return lost("too_dark",
                "the image is too dark; lengthen the exposure or add light; slam.use_odometry and "
                "slam.use_imu bridge dark places");
  }
  if (deviation[0] < kLoss.even_contrast) {
    return lost("covered",
                "the image is an even grey, as of a covered lens or a wall before it; check the "
                "lens; slam.use_odometry and slam.use_imu bridge short times");
  }
  if (const std::string blur = blurOf(stereo::edgeWidths(frame.left)); !blur.empty()) {
    return lost("blurred", blur +
                               "; shorten the exposure or turn more slowly, and check the focus; "
                               "slam.use_imu predicts turns");
  }
  if (cornersOf(frame.left) < kLoss.few_corners) {
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
  const auto [has_left, has_right] = checkExposure(frame, findings);
  // The same buffer is no second image, unless it is given for both sides.
  const bool is_left_again = has_left && left_.data != frame.left.data && isSame(left_, frame.left);
  const bool is_right_again =
      has_right && right_.data != frame.right.data && isSame(right_, frame.right);
  const bool is_pair = !frame.right.empty();
  is_frozen_ = is_left_again && has_right && (!is_pair || is_right_again);
  std::string missing;
  bool is_said = true;
  if (is_pair && has_left != has_right) {
    missing = std::string("the ") + (has_left ? "right" : "left") + " image shows nothing";
  } else if (is_pair && is_left_again != is_right_again) {
    missing = std::string("the ") + (is_left_again ? "left" : "right") + " image comes again";
  } else if (is_pair && has_left && isSame(frame.left, frame.right)) {
    missing = "left and right image are the same";
    is_said = were_two_;  // who reads the images refuses those that begin so
  }
  is_one_missing_ = !missing.empty();
  were_two_ = were_two_ || (is_pair && has_left && !is_one_missing_);
  if (is_frozen_) {
    findings.push_back({"camera_frozen", frame.index,
                        "the camera delivers the same images again: the pose is unreliable unless "
                        "wheel odometry stands; check its cable and its driver"});
  } else if (is_one_missing_ && is_said) {
    findings.push_back({"one_image", frame.index,
                        missing + ", so that nothing can be measured: the pose is unreliable "
                                  "unless wheel odometry stands; check lens, cable and driver"});
  }
  left_ = frame.left;
  right_ = frame.right;
  return findings;
}

}  // namespace headway::pipeline
