// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/sim/sim_params.h>

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace headway::sim {

/// What a real camera does to a clean picture: loss of light in the corners, brightness that
/// wanders, a gain that differs between the two cameras, and sensor noise.
class ImageFormation {
 public:
  ImageFormation(const CameraParams& params, int width, int height, std::uint64_t seed);

  enum class Side { kLeft, kRight };
  /// @param picture  8-bit BGR, clean
  /// @param frame    number of the frame; noise depends on it and on the side
  /// @return         8-bit BGR, or grey if the camera has no colour
  [[nodiscard]] cv::Mat expose(const cv::Mat& picture, std::size_t frame, Side side) const;

 private:
  CameraParams params_;
  std::uint64_t seed_;
  cv::Mat light_;  ///< ratio of light that arrives at each pixel, 255 = all; empty: everywhere all
  cv::Mat noise_;  ///< a sheet of noise larger than the image, 8-bit, mean 128
};

}  // namespace headway::sim
