// SPDX-License-Identifier: BSD-3-Clause
// Image pyramids, contrast-stretched in poor light.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

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
