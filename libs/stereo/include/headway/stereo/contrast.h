#pragma once

#include <opencv2/core/mat.hpp>

namespace headway::stereo {

/// Grey values of one camera turned to others: value -> gain * value + offset.
struct ContrastStretch {
  double gain = 1.0;
  double offset = 0.0;
};

/// What an image lacks of the contrast that it would have in good light.
///
/// At night, in fog and before bare walls, all grey values lie close together, and whatever is
/// compared with a number of grey values (corners, gradients) would find nothing there.
[[nodiscard]] ContrastStretch stretchFor(const cv::Mat& image);

/// The image with its contrast stretched; the image itself where there is nothing to stretch.
[[nodiscard]] cv::Mat stretched(const cv::Mat& image, const ContrastStretch& stretch);

}  // namespace headway::stereo
