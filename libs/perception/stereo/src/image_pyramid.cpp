// SPDX-License-Identifier: BSD-3-Clause
#include <headway/stereo/image_pyramid.h>

#include <algorithm>
#include <opencv2/video/tracking.hpp>

namespace headway::stereo {

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
