#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::stereo {

/// An image and its halved copies: pixel (x, y) of level l stands at (x, y) * 2^l of level 0.
///
/// Level 0 shares the pixels of the image that it was made from.
struct ImagePyramid {
  std::vector<cv::Mat> levels;

  [[nodiscard]] bool empty() const { return levels.empty(); }
  [[nodiscard]] int count() const { return static_cast<int>(levels.size()); }
};

/// Builds `count` levels (fewer where the image gets smaller than 32 px).
///
/// Burt & Adelson 1983: each level is smoothed by a 5x5 binomial filter before it is halved.
[[nodiscard]] ImagePyramid buildPyramid(const cv::Mat& image, int count);

}  // namespace headway::stereo
