// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

namespace headway::stereo {

/// Linear map of grey values: value -> gain * value + offset.
struct ContrastStretch {
  double gain = 1.0;
  double offset = 0.0;
};

/// The stretch that gives an image the contrast of good light.
///
/// At night, in fog and before bare walls, grey values lie close together, so thresholds in grey
/// values (corners, gradients) would reject everything.
[[nodiscard]] ContrastStretch stretchFor(const cv::Mat& image);

/// The image with its contrast stretched; the image itself where there is nothing to stretch.
[[nodiscard]] cv::Mat stretched(const cv::Mat& image, const ContrastStretch& stretch);

}  // namespace headway::stereo
