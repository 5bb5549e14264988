// SPDX-License-Identifier: BSD-3-Clause
#include <headway/stereo/contrast.h>

#include <algorithm>
#include <opencv2/core.hpp>

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

}  // namespace headway::stereo
