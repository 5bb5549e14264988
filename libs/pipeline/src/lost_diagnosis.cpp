// SPDX-License-Identifier: BSD-3-Clause
#include <headway/pipeline/lost_diagnosis.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::pipeline {
namespace {

constexpr double kMaxDarkGrey = 20.0;  // mean grey level
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

const char* toString(LostReason reason) {
  switch (reason) {
    case LostReason::kTooDark:
      return "too_dark";
    case LostReason::kCovered:
      return "covered";
    case LostReason::kBlurred:
      return "blurred";
    case LostReason::kFewFeatures:
      return "few_features";
    case LostReason::kMovedTooFast:
      return "moved_too_fast";
  }
  return "unknown";
}

std::string explanationOf(LostReason reason) {
  switch (reason) {
    case LostReason::kTooDark:
      return "the image is too dark; lengthen the exposure or add light; slam.use_odometry and "
             "slam.use_imu bridge dark places";
    case LostReason::kCovered:
      return "the image is an even grey, as of a covered lens or a wall before it; check the lens; "
             "slam.use_odometry and slam.use_imu bridge short times";
    case LostReason::kBlurred:
      return "the image is blurred; shorten the exposure or turn more slowly, and check the focus; "
             "slam.use_imu predicts turns";
    case LostReason::kFewFeatures:
      return "the image shows too few features, as of bare walls; more slam.features and wheel "
             "odometry (slam.use_odometry) help";
    case LostReason::kMovedTooFast:
      return "the view differs too much from the one before; raise the frame rate, or let "
             "slam.use_imu and slam.use_odometry predict the motion";
  }
  return "";
}

void LostDiagnosis::addTracked(const StereoFrame& frame) {
  if (frames_++ % kMeasuredEvery != 0) return;
  const double sharpness = sharpnessOf(frame.left);
  sharpness_ = sharpness_ ? *sharpness_ + kSharpnessWeight * (sharpness - *sharpness_) : sharpness;
}

LostReason LostDiagnosis::reasonOf(const StereoFrame& frame) const {
  cv::Scalar mean, deviation;
  cv::meanStdDev(frame.left, mean, deviation);
  if (mean[0] < kMaxDarkGrey) return LostReason::kTooDark;
  if (deviation[0] < kEvenContrast) return LostReason::kCovered;
  const double sharpness = sharpnessOf(frame.left);
  const double least = sharpness_ ? kBlurredRatio * *sharpness_ : kUnsharp;
  if (sharpness < least) return LostReason::kBlurred;
  return cornersOf(frame.left) < kFewCorners ? LostReason::kFewFeatures : LostReason::kMovedTooFast;
}

}  // namespace headway::pipeline
