// SPDX-License-Identifier: BSD-3-Clause
#include <headway/stereo/reduced_image.h>
#include <headway/stereo/surface_disparity.h>

#include <opencv2/imgproc.hpp>

namespace headway::stereo {
namespace {

constexpr int kWindow = 7;        // [px of the reduced image]
constexpr int kIterations = 2;    // of the refinement
constexpr float kMaxStep = 1.0F;  // more than this is another match [px of the reduced image]
// Squared intensity differences that noise of 2 grey levels turns into 0.25 px of disparity.
constexpr float kMinTexture = 64.0F;

cv::Mat windowMean(const cv::Mat& values) {
  cv::Mat mean;
  cv::boxFilter(values, mean, CV_32F, {kWindow, kWindow});
  return mean;
}

cv::Mat acrossGradient(const cv::Mat& image) {
  cv::Mat gradient;
  cv::Sobel(image, gradient, CV_32F, 1, 0, 1, 0.5);
  return gradient;
}

/// The right image as it is seen from the left one.
cv::Mat warped(const cv::Mat& right, const cv::Mat& disparity) {
  cv::Mat columns(disparity.size(), CV_32F), rows(disparity.size(), CV_32F);
  for (int row = 0; row < disparity.rows; ++row) {
    const auto* d = disparity.ptr<float>(row);
    auto* column_in = columns.ptr<float>(row);
    for (int column = 0; column < disparity.cols; ++column) {
      column_in[column] = static_cast<float>(column) - d[column];
    }
    rows.row(row).setTo(static_cast<float>(row));
  }
  cv::Mat result;
  cv::remap(right, result, columns, rows, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

/// One step of least squares towards equal intensities, which may differ by a constant; 0 where
/// there is no texture [px of the reduced image].
cv::Mat stepOf(const cv::Mat& left, const cv::Mat& right, const cv::Mat& disparity,
               const cv::Mat& known) {
  const cv::Mat seen = warped(right, disparity);
  cv::Mat gradient = 0.5F * (acrossGradient(left) + acrossGradient(seen));
  cv::Mat difference = seen - left;
  gradient.setTo(0.0F, ~known);
  difference.setTo(0.0F, ~known);
  difference -= windowMean(difference);
  const cv::Mat texture =
      static_cast<double>(kWindow * kWindow) * windowMean(gradient.mul(gradient));
  const cv::Mat product =
      static_cast<double>(kWindow * kWindow) * windowMean(gradient.mul(difference));
  cv::Mat step = product / cv::max(texture, kMinTexture);
  step.setTo(0.0F, (texture < kMinTexture) | ~known);
  return step;
}

void refine(const cv::Mat& left, const cv::Mat& right, cv::Mat& disparity) {
  const cv::Mat known = disparity > 0.0F;
  cv::Mat refined = disparity.clone();
  for (int i = 0; i < kIterations; ++i) refined += stepOf(left, right, refined, known);
  const cv::Mat is_same_match = known & (cv::abs(refined - disparity) <= kMaxStep);
  refined.copyTo(disparity, is_same_match);
}

}  // namespace

DisparityImage surfaceDisparity(const StereoFrame& frame, DisparityParams params) {
  params.method = DisparityParams::Method::kSemiGlobal;
  DisparityImage result = denseDisparity(frame, params);
  if (!frame.disparity.empty() || result.coverage() == 0.0) return result;
  cv::Mat left, right;
  reducedImage(frame.left, params.reduce).convertTo(left, CV_32F);
  reducedImage(frame.right, params.reduce).convertTo(right, CV_32F);
  cv::Mat reduced = result.values / static_cast<double>(params.reduce);
  refine(left, right, reduced);
  result.values = static_cast<double>(params.reduce) * cv::max(reduced, 0.0F);
  return result;
}

void subtractOffset(double offset_px, DisparityImage& disparity) {
  if (offset_px == 0.0) return;
  cv::subtract(disparity.values, offset_px, disparity.values, disparity.values > 0.0F);
  cv::max(disparity.values, 0.0F, disparity.values);
}

}  // namespace headway::stereo
