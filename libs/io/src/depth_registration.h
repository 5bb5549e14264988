// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/io/rawlog_sink.h>

#include <opencv2/core/mat.hpp>

namespace headway::io {

/// Baseline of the stereo camera whose disparities have the noise of a depth camera [m].
///
/// Errors of structured light and of stereo cameras grow with the square of the depth, which is a
/// constant error of a disparity: sigma_z = k z^2 = z^2 s / (f b). With k = 0.0025 / m, measured
/// for such cameras, and s = 0.4 px, what headway assumes of disparities, all thresholds hold that
/// were made for stereo cameras.
///
/// @param focal_px  of the images that disparities belong to
/// @see  Khoshelham & Elberink 2012, "Accuracy and resolution of Kinect depth data" (k = 0.0014);
///       Ahn et al. 2019, "Analysis and noise modeling of the Intel RealSense D435" (k = 0.002)
[[nodiscard]] double equivalentBaseline(double focal_px);

/// @throws InputError naming what is impossible about a lens, a pose or the unit
void validate(const RawDepthCamera& camera);

/// Converts depth images to disparities of the rectified intensity image.
///
///     DepthRegistration registration(recorded, rectifier.camera());
///     frame.disparity = registration.disparities(ranges);
class DepthRegistration {
 public:
  /// @param recorded  validated
  /// @param target    rectified intensity camera, with the recorded one's axes
  DepthRegistration(const RawDepthCamera& recorded, const StereoCamera& target);

  /// @param ranges  16-bit, of the depth camera's size; 0 and 65535 are holes
  /// @return        32-bit float [px], 0 where nothing was measured, or at edges of surfaces
  [[nodiscard]] cv::Mat disparities(const cv::Mat& ranges) const;

  [[nodiscard]] cv::Size size() const { return {recorded_.depth.width, recorded_.depth.height}; }

 private:
  [[nodiscard]] cv::Mat projected(const cv::Mat& ranges) const;

  RawDepthCamera recorded_;
  StereoCamera target_;
  cv::Mat rays_;                ///< (x/z, y/z) of each depth pixel, 32-bit
  bool is_registered_ = false;  ///< pixels are those of the rectified intensity image
};

}  // namespace headway::io
