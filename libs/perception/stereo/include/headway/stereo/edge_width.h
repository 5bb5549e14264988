// SPDX-License-Identifier: BSD-3-Clause
// Width of the edges in an image, which grows with blur.
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>

namespace headway::stereo {

/// Width of the edges along rows and along columns [px], by every 8th row and column.
///
/// The root of the energy of the first derivative over that of the second, both smoothed by
/// (1 4 6 4 1) / 16, without that of white noise. A step gives 3.0, one that motion blurs over b >
/// 4 px about 2.7 sqrt(b); light and contrast hardly matter. Sharp images of KITTI, EuRoC, a
/// RealSense and a Kinect have 2.6 to 3.6.
///
/// @param image  8-bit grey
/// @return       0 where there is no structure
[[nodiscard]] std::array<double, 2> edgeWidths(const cv::Mat& image);

}  // namespace headway::stereo
