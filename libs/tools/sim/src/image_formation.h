// SPDX-License-Identifier: BSD-3-Clause
// What a camera does to time, brightness and depth: trigger, exposure, noise.
#pragma once

#include <headway/core/random.h>
#include <headway/core/stereo_camera.h>
#include <headway/sim/sim_params.h>

#include <algorithm>
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace headway::sim {

/// When the camera takes its frames: on the beat, but for jitter and for frames that are lost.
///
/// The first frame is what time is counted from: it comes at 0 and is never lost.
class CameraClock {
 public:
  struct Beat {
    double time_s = 0.0;  ///< middle of the exposure, since the first frame [s]
    bool lost = false;
  };

  CameraClock(const CameraParams& params, std::uint64_t seed) : params_(params), random_(seed) {}

  [[nodiscard]] Beat next() {
    const double sigma = params_.jitter_s;
    const double jitter = std::clamp(sigma * random_.normal(), -3.0 * sigma, 3.0 * sigma);
    const auto beat = static_cast<double>(beats_++);
    if (beat == 0.0) return {};
    return {beat / params_.rate_hz + jitter, random_.chance(params_.drop_ratio)};
  }

 private:
  CameraParams params_;
  Random random_;
  std::size_t beats_ = 0;  ///< so far, lost frames included
};

/// What a real camera does to a clean picture: loss of light in the corners, brightness that
/// wanders, a gain that differs between the two cameras, a tone curve, and sensor noise.
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
  cv::Mat tones_;  ///< of each brightness; empty: the same
};

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
