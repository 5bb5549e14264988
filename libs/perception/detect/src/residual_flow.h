// SPDX-License-Identifier: BSD-3-Clause
// Flow of the image against that of a static scene: where something moves across the line of sight.
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/stereo/disparity.h>

#include <deque>
#include <opencv2/core/mat.hpp>

#include "camera_path.h"

namespace headway::detect {

/// Flow along image rows between two frames, less the flow of a static scene.
struct ResidualFlow {
  cv::Mat columns;       ///< for each disparity cell, to the right [px]; 32-bit, NaN where unknown
  cv::Mat sigmas;        ///< of a static cell, by depth and camera motion [px]; 32-bit
  double seconds = 0.0;  ///< between the frames

  [[nodiscard]] bool empty() const { return columns.empty(); }
};

/// Measures residual flow densely.
///
/// The previous frame is warped by the measured disparities and the camera's motion to the current
/// view of a static scene. Static cells then coincide. Objects on the ground are displaced along
/// rows, since they hardly move vertically, so the search is that of stereo matching: along rows
/// and without a pyramid, whose coarse levels would give small objects the flow of the background.
/// The flow common to all cells, an error of the camera's motion, is subtracted; the remaining
/// scatter is the noise.
class ResidualFlowMeter {
 public:
  explicit ResidualFlowMeter(const StereoCamera& camera) : camera_(camera) {}

  /// Measures from a frame handed in before to this one, the newest of the path: from the newest
  /// that is old enough for a walk to show, the one before at 10 Hz.
  ///
  /// @param image  left, on the disparity grid, 8-bit; shared, must not be changed afterwards
  /// @return       empty for the first frames
  [[nodiscard]] ResidualFlow measure(const cv::Mat& image, const stereo::DisparityImage& disparity,
                                     const CameraPath& path);
  void clear() { images_.clear(); }

 private:
  struct Image {
    int frame;      ///< of the path
    cv::Mat image;  ///< left, on the disparity grid
  };
  StereoCamera camera_;
  std::deque<Image> images_;  ///< from the one that is measured from on
};

}  // namespace headway::detect
