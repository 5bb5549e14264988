// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::stereo {

/// The image at 1/reduce of its size, each pixel the mean of those that it stands for; the image
/// itself, not a copy, where that is 1.
inline cv::Mat reducedImage(const cv::Mat& image, int reduce) {
  if (reduce == 1) return image;
  cv::Mat result;
  cv::resize(image, result, {image.cols / reduce, image.rows / reduce}, 0, 0, cv::INTER_AREA);
  return result;
}

}  // namespace headway::stereo
