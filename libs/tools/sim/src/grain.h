// SPDX-License-Identifier: BSD-3-Clause
// Random textures and colours.
#pragma once

#include <headway/core/random.h>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace headway::sim {

// Compilers choose in which order a call's arguments are evaluated, so no call draws two random
// numbers in its arguments: each is drawn by a statement of its own, and a world depends on its
// seed alone.

/// A colour with each channel in [low, high).
inline cv::Scalar drawColour(double low, double high, Random& random) {
  const double red = random.uniform(low, high);
  const double green = random.uniform(low, high);
  const double blue = random.uniform(low, high);
  return {blue, green, red};
}

/// A point with x in [0, width) and y in [0, height).
inline cv::Point drawPoint(int width, int height, Random& random) {
  const int y = random.below(height);
  const int x = random.below(width);
  return {x, y};
}

/// Surface structure that never repeats: patches cut at random from large sheets of noise.
///
/// The sheets are made once; a patch costs little more than a copy. `coarse` noise varies over
/// tens of pixels (stains, wear), `fine` from pixel to pixel (grit).
class Grain {
 public:
  explicit Grain(std::uint64_t seed);

  /// Adds `fine` and `coarse` grey levels (standard deviations) of noise to a BGR picture.
  void roughen(cv::Mat& picture, double fine, double coarse, Random& random) const;

 private:
  [[nodiscard]] cv::Mat patch(const cv::Mat& sheet, int width, int height, Random& random) const;

  cv::Mat fine_;    ///< 8-bit, mean 128, standard deviation 32
  cv::Mat coarse_;  ///< 8-bit, mean 128, standard deviation 32
};

}  // namespace headway::sim
