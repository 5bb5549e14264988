// SPDX-License-Identifier: BSD-3-Clause
// Image pyramids, contrast-stretched in poor light.
#include <headway/stereo/image_pyramid.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/video/tracking.hpp>

namespace headway::stereo {

ContrastStretch stretchFor(const cv::Mat& image) {
  constexpr double kFullContrast = 40.0;  ///< standard deviation in good light [grey values]
  constexpr double kMaxGain = 6.0;        ///< the camera's noise grows with the contrast
  constexpr double kMiddle = 128.0;
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  if (deviation[0] >= kFullContrast) return {};
  const double gain = std::min(kFullContrast / std::max(deviation[0], 1e-3), kMaxGain);
  return {gain, kMiddle - gain * mean[0]};
}

cv::Mat stretched(const cv::Mat& image, const ContrastStretch& stretch) {
  if (stretch.gain == 1.0) return image;
  cv::Mat result;
  image.convertTo(result, CV_8U, stretch.gain, stretch.offset);
  return result;
}

ImagePyramid buildPyramid(const cv::Mat& image, int count, Gradients gradients) {
  constexpr int kMinSize = 32;
  int levels = 1;
  for (int size = std::min(image.cols, image.rows); levels < count && size >= 2 * kMinSize;
       size = (size + 1) / 2) {
    ++levels;
  }
  const bool with_gradients = gradients == Gradients::kAll;
  std::vector<cv::Mat> mats;
  cv::buildOpticalFlowPyramid(image, mats, {kMaxTrackingWindow, kMaxTrackingWindow}, levels - 1,
                              with_gradients, cv::BORDER_REFLECT_101, cv::BORDER_CONSTANT, false);
  ImagePyramid pyramid;
  const std::size_t step = with_gradients ? 2 : 1;
  for (std::size_t i = 0; i < mats.size(); i += step) {
    pyramid.levels.push_back(mats[i]);
    if (with_gradients) pyramid.gradients.push_back(mats[i + 1]);
  }
  return pyramid;
}

}  // namespace headway::stereo
