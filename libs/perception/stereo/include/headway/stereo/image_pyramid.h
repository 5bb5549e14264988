// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::stereo {

/// Largest window by which points are tracked [px]; the levels are padded by as much.
inline constexpr int kMaxTrackingWindow = 15;

/// An image and its halved copies: pixel (x, y) of level l stands at (x, y) * 2^l of level 0.
struct ImagePyramid {
  std::vector<cv::Mat> levels;     ///< 8-bit, each the inside of a padded image
  std::vector<cv::Mat> gradients;  ///< of each level, (du, dv), 16-bit; may be empty

  [[nodiscard]] bool empty() const { return levels.empty(); }
  [[nodiscard]] int count() const { return static_cast<int>(levels.size()); }
};

enum class Gradients { kNone, kAll };

/// Builds `count` levels (fewer where the image gets smaller than 32 px).
///
/// Burt & Adelson 1983: each level is smoothed by a 5x5 binomial filter before it is halved.
///
/// @param gradients  needed of images that points are tracked from
[[nodiscard]] ImagePyramid buildPyramid(const cv::Mat& image, int count,
                                        Gradients gradients = Gradients::kNone);

}  // namespace headway::stereo
