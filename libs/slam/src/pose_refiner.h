#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

namespace headway::slam {

/// One landmark as measured in one frame.
struct StereoMeasurement {
  Eigen::Vector2d uv = Eigen::Vector2d::Zero();  ///< left image [px]
  double disparity = 0.0;                        ///< [px], only meaningful where stereo
  bool stereo = false;                           ///< found in the right image, too
  double sigma_px = 1.0;                         ///< of u and v
  double sigma_disparity_px = 1.0;               ///< of the disparity
};

/// A landmark's place and where it was measured.
struct PoseConstraint {
  Eigen::Vector3d point_map = Eigen::Vector3d::Zero();  ///< [m]
  StereoMeasurement measurement;
  bool inlier = true;         ///< set by refinePose
  bool stereo_inlier = true;  ///< its disparity fits as well; set by refinePose
};

/// Residual (u, v, disparity) of a point in the camera, each divided by its sigma; the disparity's
/// is 0 where it was not measured.
///
/// @param point_cam  in front of the camera [m]
/// @param jacobian   d residual / d point_cam, or null
[[nodiscard]] Eigen::Vector3d stereoResidual(const Eigen::Vector3d& point_cam,
                                             const StereoMeasurement& measurement,
                                             const StereoCamera& camera, Eigen::Matrix3d* jacobian);

/// d point_cam / d xi for T_map_cam * exp(xi), xi = (translation, rotation).
[[nodiscard]] Eigen::Matrix<double, 3, 6> pointByPose(const Eigen::Vector3d& point_cam);

/// The pose moved by xi = (translation [m], rotation [rad]) as seen from itself.
[[nodiscard]] Pose retract(const Pose& pose, const Eigen::Matrix<double, 6, 1>& xi);

/// A pose that rests on landmarks.
struct RefinedPose {
  Pose T_map_cam = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Identity();  ///< scaled by the residuals' variance
  int inliers = 0;
};

/// How measurements that do not fit are treated.
struct PoseRefinerOptions {
  double first_scale = 1.0;  ///< the Cauchy loss starts this many times wider than at its end
  int rounds = 3;            ///< each one halves the scale down to 1 and sorts inliers anew
  int iterations = 6;        ///< Levenberg-Marquardt steps a round
};

/// Sorts the constraints into inliers and outliers at a pose.
///
/// @param scale  the gate, 99 % of right measurements, is widened by this factor
/// @return       number of inliers
int markInliers(const Pose& T_map_cam, std::vector<PoseConstraint>& constraints,
                const StereoCamera& camera, double scale);

/// The pose that the measurements agree on best, from a first guess.
///
/// Levenberg-Marquardt with a Cauchy loss on image position and disparity apart, so that one wrong
/// stereo match does not cost a good track. Marks inliers in the constraints.
///
/// @return nullopt if fewer than 4 constraints fit or the problem is degenerate
/// @see Hartley & Zisserman 2004, app. 6; Black & Rangarajan 1996 (robust losses)
[[nodiscard]] std::optional<RefinedPose> refinePose(const Pose& T_map_cam_guess,
                                                    std::vector<PoseConstraint>& constraints,
                                                    const StereoCamera& camera,
                                                    const PoseRefinerOptions& options);

}  // namespace headway::slam
