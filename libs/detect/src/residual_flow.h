#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/stereo/disparity.h>

#include <opencv2/core/mat.hpp>

#include "camera_path.h"

namespace headway::detect {

/// How far the image moved sideways between two frames beyond what the camera's motion explains.
struct ResidualFlow {
  cv::Mat columns;       ///< for each disparity cell, to the right [px]; 32-bit, NaN where unknown
  cv::Mat sigmas;        ///< of a still cell, by its depth and the camera's motion [px]; 32-bit
  double seconds = 0.0;  ///< between the frames

  [[nodiscard]] bool empty() const { return columns.empty(); }
};

/// Measures residual flow densely.
///
/// The frame before is warped to where a still world of the measured disparities would show it now.
/// What stands then coincides, and what moves over the ground is, seen by a camera at eye level,
/// displaced along its row, for people hardly move up and down. So the search for it is that of
/// stereo: along rows, without a pyramid, whose coarse levels would give small things the motion
/// of what is behind them. What all cells have in common, as errors of the camera's motion make it,
/// is taken off; the rest of it is the noise.
class ResidualFlowMeter {
 public:
  explicit ResidualFlowMeter(const StereoCamera& camera) : camera_(camera) {}

  /// Measures from the frame handed in before to this one, the newest of the path.
  ///
  /// @param image  left, on the disparity grid, 8-bit; shared, must not be changed afterwards
  /// @return       empty for the first frame
  [[nodiscard]] ResidualFlow measure(const cv::Mat& image, const stereo::DisparityImage& disparity,
                                     const CameraPath& path);
  void clear() { before_ = cv::Mat(); }

 private:
  StereoCamera camera_;
  cv::Mat before_;  ///< left image of the frame before, on the disparity grid
};

}  // namespace headway::detect
