#pragma once

#include <headway/stereo/disparity.h>
#include <headway/stereo/ground_plane.h>

#include <optional>
#include <vector>

#include "camera_path.h"
#include "motion_verdict.h"
#include "point_follower.h"

namespace headway::detect {

/// What is known of a frame when movers are looked for in it.
struct LookedAt {
  const CameraPath& path;
  const cv::Mat& image;  ///< left, on the disparity grid
  const stereo::DisparityImage& disparity;
  const std::optional<stereo::GroundPlane>& ground;
  const Eigen::Vector3d& up;  ///< normal of the ground, world of the path
  const std::vector<PointTrack>& points;
  const std::vector<PointVerdict>& verdicts;  ///< one for each point
  double noise_scale = 1.0;                   ///< true errors of sightings over those assumed [-]
};

}  // namespace headway::detect
