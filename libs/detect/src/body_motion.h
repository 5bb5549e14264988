#pragma once

#include <headway/core/detection.h>

#include <deque>
#include <optional>
#include <vector>

#include "point_follower.h"
#include "upright_blobs.h"

namespace headway::detect {

/// How a body moves as a whole, by all that is followed on it.
struct BodyMotion {
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< over the ground, world of the path [m/s]
  Eigen::Matrix3d covariance =
      Eigen::Matrix3d::Identity();  ///< with all errors common to its parts
  double evidence = 0.0;  ///< that it moves: chi-square of 2 degrees of freedom if it stands
  int parts = 0;          ///< that tell of it
  double across = 0.0;  ///< of the velocity, by its flow alone; 0 where that was not measured [m/s]
  double across_sigma = 0.0;  ///< [m/s]
};

/// How well bodies are measured.
struct BodyParams {
  int least_sightings = 4;
  int least_parts = 3;
  int least_flows = 2;         ///< one may be a mismatch
  double noise_scale = 1.0;    ///< true errors of sightings over those assumed [-]
  double speed_prior = 3.0;    ///< standard deviation of a body's speed [m/s]
  double common_px = 0.3;      ///< drift of the camera's direction over the sightings [px]
  double common_share = 0.01;  ///< errors of calibration and motion, of the camera's speed [-]
  double common_disparity_px = 0.2;  ///< drift of a body's disparity over them [px]
};

/// Pools what is known of a body's parts: points on it that are followed, and its outline.
///
/// A walker along the line of sight moves each point on him hardly more than its error; of all of
/// them together that is evidence. The points are not chosen by how they move, so that pooling is
/// no biased choice; limbs and what lies behind weigh little (Cauchy). Errors common to all parts,
/// of the camera's motion and of stereo, do not shrink with their number.
///
/// @param outline  motion of the body's outline, where it was followed
/// @param across   of the body, by its flow, in each of the last frames
/// @param up       unit normal of the ground, in the world of the path
/// @return         nullopt where too few parts are followed
[[nodiscard]] std::optional<BodyMotion> bodyMotion(
    const UprightBlob& body, const std::optional<PointMotion>& outline,
    const std::deque<AcrossSpeed>& across, const std::vector<PointTrack>& points,
    const stereo::DisparityImage& disparity, const CameraPath& path, const StereoCamera& camera,
    const Eigen::Vector3d& up, const BodyParams& params);

}  // namespace headway::detect
