// SPDX-License-Identifier: BSD-3-Clause
#include <headway/stereo/ground_disparity.h>
#include <headway/stereo/reduced_image.h>

#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "block_matcher.h"

namespace headway::stereo {
namespace {

constexpr int kResiduals = 16;       // whole pixels that are searched, half of them on either side
constexpr int kWindow = 7;           // in which matches support each other [reduced px]
constexpr double kMinDensity = 0.3;  // of them; of what is not the ground, an eighth fits by chance
constexpr double kMinSlope = 1e-3;   // of the disparity, from row to row: a camera looks ahead

/// Disparity of a plane in the cells of a reduced image, in which it is linear [its pixels].
struct PlaneDisparity {
  double by_column, by_row, first;

  PlaneDisparity(const StereoCamera& camera, const GroundPlane& ground, int reduce) {
    const Eigen::Vector3d scaled =
        -camera.fx * camera.baseline_m / ground.camera_height * ground.up;
    by_column = scaled.x() / camera.fx;
    by_row = scaled.y() / camera.fy;
    const double pixel = 0.5 * (reduce - 1);  // of the first cell
    first = (scaled.z() + (pixel - camera.cx) * by_column + (pixel - camera.cy) * by_row) / reduce;
  }
  [[nodiscard]] double at(double column, double row) const {
    return first + by_column * column + by_row * row;
  }
  /// First row in which it is as great as a value anywhere.
  [[nodiscard]] double rowOf(double value, int columns) const {
    return (value - std::max(first, at(columns - 1.0, 0.0))) / by_row;
  }
  /// What maps an image's rows from one on to a right image in which the plane has no disparity.
  [[nodiscard]] cv::Matx23d shear(int from_row) const {
    return {1.0 - by_column, -by_row, -at(0.0, from_row), 0.0, 1.0, 0.0};
  }
};

/// Disparities less the plane's; less than -kResiduals / 2 where there are none [px / kSubpixels].
cv::Mat matchResiduals(const cv::Mat& left, const cv::Mat& sheared, int block_px) {
  auto matcher = blockMatcher(kResiduals, block_px);
  matcher->setMinDisparity(-kResiduals / 2);
  matcher->setUniquenessRatio(0);
  // Not both ways and with speckles, which is twice as fast: dropScattered() removes them.
  matcher->setDisp12MaxDiff(-1);
  matcher->setSpeckleWindowSize(0);
  cv::Mat residuals;
  matcher->compute(left, sheared, residuals);
  return residuals;
}

/// Disparities within the plane's tolerance in a row, and not less than the least one.
void enterRow(const std::int16_t* residuals, const PlaneDisparity& plane, const GroundPlane& ground,
              int row, double focal_baseline, double least, cv::Mat& values) {
  const double middle = plane.at(0.5 * values.cols, row);
  if (!(middle > 0.0)) return;
  // A point at height h above the plane has 1 / (1 - h / H) times its disparity.
  const double ratio = ground.tolerance(focal_baseline / middle) / ground.camera_height;
  auto* value = values.ptr<float>(row);
  for (int column = 0; column < values.cols; ++column) {
    if (residuals[column] < -kResiduals / 2 * kSubpixels) continue;
    const double rest = residuals[column] / static_cast<double>(kSubpixels);
    const double matched = rest + plane.at(column - rest, row);
    const bool is_ground = std::abs(matched - plane.at(column, row)) <= ratio * matched;
    if (is_ground && matched >= least) value[column] = static_cast<float>(matched);
  }
}

/// Removes matches of which too few are around.
void dropScattered(cv::Mat& values) {
  cv::Mat density;
  const cv::Mat matched = values > 0.0F;
  cv::blur(matched, density, {kWindow, kWindow});
  values.setTo(0.0F, density < kMinDensity * 255.0);
}

}  // namespace

DisparityImage groundDisparity(const StereoFrame& frame, const GroundPlane& ground,
                               const DisparityParams& params, double to_m) {
  const StereoCamera& camera = *frame.camera;
  const int reduce = params.reduce;
  const int block_px = params.block_px | 1;
  DisparityImage result;
  result.reduce = reduce;
  const cv::Size size(frame.left.cols / reduce, frame.left.rows / reduce);
  result.values = cv::Mat(size, CV_32F, cv::Scalar(0));
  const PlaneDisparity plane(camera, ground, reduce);
  if (!frame.disparity.empty() || !(plane.by_row > kMinSlope)) return result;
  const double focal_baseline = camera.fx * camera.baseline_m / reduce;
  const double least = focal_baseline / to_m;
  const double horizon = std::clamp<double>(plane.rowOf(least, size.width), 0.0, size.height);
  const int from = std::max(0, static_cast<int>(horizon) - block_px);
  if (size.height - from <= 2 * block_px || size.width <= 2 * kResiduals) return result;
  const auto below = [&](const cv::Mat& image) {
    return reducedImage(image, reduce).rowRange(from, size.height);
  };
  const cv::Mat left = below(frame.left), right = below(frame.right);
  cv::Mat sheared;
  cv::warpAffine(right, sheared, plane.shear(from), left.size(),
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP);
  const cv::Mat residuals = matchResiduals(left, sheared, block_px);
  for (int row = from; row < size.height; ++row) {
    enterRow(residuals.ptr<std::int16_t>(row - from), plane, ground, row, focal_baseline, least,
             result.values);
  }
  cv::Mat matched = result.values.rowRange(from, size.height);
  dropScattered(matched);
  matched *= reduce;
  return result;
}

}  // namespace headway::stereo
