// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>

#include <opencv2/core/mat.hpp>

namespace headway::sim {

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
