#include <headway/pipeline/camera_check.h>

#include <algorithm>
#include <cstring>
#include <opencv2/core.hpp>

namespace headway::pipeline {
namespace {

constexpr int kRowStep = 16;           ///< distance of the compared rows [px]
constexpr double kDarkGrey = 16.0;     ///< mean grey level below which an image is dark
constexpr double kDarkContrast = 2.0;  ///< standard deviation of its grey levels

bool isSame(const cv::Mat& a, const cv::Mat& b) {
  if (a.empty() || a.size() != b.size() || a.data == b.data) return false;
  for (int row = 0; row < a.rows; row += kRowStep) {
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols)) != 0) return false;
  }
  return true;
}

bool isDark(const cv::Mat& image) {
  cv::Mat mean, deviation;
  double sum = 0.0;
  double contrast = 0.0;
  int rows = 0;
  for (int row = 0; row < image.rows; row += kRowStep, ++rows) {
    cv::meanStdDev(image.row(row), mean, deviation);
    sum += mean.at<double>(0);
    contrast = std::max(contrast, deviation.at<double>(0));
  }
  return rows > 0 && sum / rows < kDarkGrey && contrast < kDarkContrast;
}

}  // namespace

void CameraCheck::add(const StereoFrame& frame, Warnings& warnings) {
  if (isDark(frame.left)) {
    addWarning("camera_dark", frame.index,
               "the left image is dark and without structure; check lens cover, exposure and light",
               warnings);
  } else if (isSame(left_, frame.left) && isSame(right_, frame.right)) {
    addWarning("camera_frozen", frame.index,
               "the camera delivers the same images again, so that the robot seems to stand still; "
               "check its cable and its driver",
               warnings);
  }
  left_ = frame.left;
  right_ = frame.right;
}

}  // namespace headway::pipeline
