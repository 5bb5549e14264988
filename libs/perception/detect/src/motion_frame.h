// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <optional>
#include <vector>

#include "camera_path.h"
#include "point_classification.h"
#include "point_follower.h"

namespace headway::detect {

/// A frame as the search for moving objects needs it.
struct MotionFrame {
  const CameraPath& path;
  const cv::Mat& image;  ///< left, on the disparity grid
  const stereo::DisparityImage& disparity;
  const std::optional<stereo::GroundPlane>& ground;
  const Eigen::Vector3d& up;  ///< normal of the ground, world of the path
  const std::vector<PointTrack>& points;
  const std::vector<PointClass>& classes;  ///< one for each point
  double noise_scale = 1.0;                ///< true errors of observations over those assumed [-]
};

}  // namespace headway::detect
