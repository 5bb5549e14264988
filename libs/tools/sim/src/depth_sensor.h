// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/sim/sim_params.h>

#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace headway::sim {

/// What a depth camera measures of true depths: noise that grows with the square of the depth and
/// is alike in neighbouring pixels, and holes where its projector does not shine, at the edges of
/// near surfaces, and beyond its range.
class DepthSensor {
 public:
  /// @param camera  of the images; its baseline is the distance of the projector, to the right
  DepthSensor(const CameraParams& params, const StereoCamera& camera, std::uint64_t seed);

  /// @param depth  true depths of the recorded pixels, 32-bit [m]; 0 where there is none
  /// @param frame  number of the frame, on which the noise depends
  /// @return       16-bit [mm]; 0 where nothing is measured
  [[nodiscard]] cv::Mat measure(const cv::Mat& depth, std::size_t frame) const;

 private:
  CameraParams params_;
  float focal_baseline_;
  std::uint64_t seed_;
  cv::Mat noise_;  ///< a sheet of noise larger than the image, 32-bit, variance 1
};

}  // namespace headway::sim
