// SPDX-License-Identifier: BSD-3-Clause
// The pose that given landmarks and their measurements agree on.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>
#include <headway/stereo/stereo_residual.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace headway::stereo {

/// A landmark's position and its measurement.
struct PoseConstraint {
  Eigen::Vector3d point_map = Eigen::Vector3d::Zero();  ///< [m]
  StereoMeasurement measurement;
  bool inlier = true;         ///< set by refinePose
  bool stereo_inlier = true;  ///< its disparity fits as well; set by refinePose
};

/// A pose estimated from landmarks.
struct RefinedPose {
  Pose T_map_cam = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Identity();  ///< scaled by the residuals' variance
  int inliers = 0;
};

/// A Gaussian prior on a pose.
struct PosePrior {
  Pose T_map_cam = Pose::Identity();
  PoseCovariance information = PoseCovariance::Zero();  ///< inverse covariance of its tangent
};

/// What one weight of the robust loss is applied to.
enum class RobustLoss {
  kSeparate,  ///< image position and disparity apart: a wrong stereo match keeps a good track
  kJoint,     ///< the whole measurement: a point that moves is wrong in all coordinates
};

/// Robust loss and its schedule.
struct PoseRefinerOptions {
  double first_scale = 1.0;  ///< the Cauchy loss starts this many times wider than at its end
  int rounds = 3;            ///< each one halves the scale down to 1 and classifies inliers again
  int iterations = 6;        ///< Levenberg-Marquardt steps a round
  RobustLoss loss = RobustLoss::kSeparate;
};

/// Sorts the constraints into inliers and outliers at a pose.
///
/// @param scale  the gate, 99 % of right measurements, is widened by this factor
/// @return       number of inliers
int markInliers(const Pose& T_map_cam, std::vector<PoseConstraint>& constraints,
                const StereoCamera& camera, double scale);

/// The pose that the measurements agree on best, from an initial pose.
///
/// Levenberg-Marquardt with a Cauchy loss. Marks inliers in the constraints.
///
/// @param prior  on the pose, or null; with one, any number of constraints is enough
/// @return nullopt if fewer than 4 constraints fit without a prior, or the problem is degenerate
/// @see Hartley & Zisserman 2004, app. 6; Black & Rangarajan 1996 (robust losses)
[[nodiscard]] std::optional<RefinedPose> refinePose(const Pose& T_map_cam_guess,
                                                    std::vector<PoseConstraint>& constraints,
                                                    const StereoCamera& camera,
                                                    const PoseRefinerOptions& options,
                                                    const PosePrior* prior = nullptr);

}  // namespace headway::stereo
