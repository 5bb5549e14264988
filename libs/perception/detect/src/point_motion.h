// SPDX-License-Identifier: BSD-3-Clause
// Motion of a point: its observations in the last frames, the fit as static and as moving, and its
// class.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/rectification.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "camera_path.h"

namespace headway::detect {

inline constexpr double kMinDisparity =
    1.0;                                    ///< of an observation; farther ones are all noise [px]
inline constexpr double kGoodFit = 3.0;     ///< squared error to a degree of freedom
inline constexpr int kMinFitted = 4;        ///< observations from which the fit of a motion counts
inline constexpr double kMinSpan_s = 0.25;  ///< of observations that show a velocity [s]
/// Growth with depth of the distances within which things belong together [m/m].
inline constexpr double kGatePerMetre = 0.02;

/// The part of a vector that lies along the ground.
///
/// @param up  unit normal of the ground
inline Eigen::Vector3d overGround(const Eigen::Vector3d& vector, const Eigen::Vector3d& up) {
  return vector - up * up.dot(vector);
}

/// Standard deviation of a vector along its own direction.
inline double sigmaAlong(const Eigen::Vector3d& vector, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d direction = vector.normalized();
  return std::sqrt(direction.dot(covariance * direction));
}

/// A point as observed in one frame.
struct Observation {
  int frame = 0;                                  ///< number on the camera path
  Eigen::Vector3d uvd = Eigen::Vector3d::Zero();  ///< left u, left v, disparity [px]
};

/// Standard deviations of an observation, and of what it shows.
struct ObservationNoise {
  double u = 0.4;                  ///< [px]
  double v = 0.4;                  ///< [px]
  double disparity = 0.4;          ///< [px]
  double acceleration_mps2 = 1.0;  ///< of people and vehicles, typical
};

/// A point fitted to its observations as static, at constant velocity, and with an acceleration.
struct PointMotion {
  Eigen::Vector3d static_point = Eigen::Vector3d::Zero();  ///< world of the path [m]
  double static_error = 0.0;        ///< squared error of the static point, in sigmas squared
  double offset_information = 0.0;  ///< of the static point on the disparities' offset [1/px^2]
  double offset_gradient = 0.0;     ///< that information times the offset [1/px]
  Eigen::Vector3d point = Eigen::Vector3d::Zero();     ///< in the newest frame, if it moves [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Identity();  ///< [m^2/s^2]
  double accelerated_error = 0.0;  ///< squared error of the moving point and of its prior
  Eigen::Vector3d steady_velocity = Eigen::Vector3d::Zero();        ///< without acceleration [m/s]
  Eigen::Matrix3d steady_covariance = Eigen::Matrix3d::Identity();  ///< [m^2/s^2]
  double moving_error = 0.0;  ///< of the steady one; noise as of the static point
  int observations = 0;       ///< that it was fitted to

  /// Squared errors to a degree of freedom: 1 where the hypothesis and the noise are right.
  [[nodiscard]] double staticFit() const { return static_error / (3.0 * (observations - 1)); }
  [[nodiscard]] stereo::OffsetEvidence offsetEvidence() const {
    return {offset_information, offset_gradient, staticFit()};
  }
  [[nodiscard]] double movingFit() const { return fitOf(accelerated_error); }
  [[nodiscard]] double steadyFit() const { return fitOf(moving_error); }

 private:
  [[nodiscard]] double fitOf(double error) const {
    return error / (3.0 * (observations - 2) + 1.0);
  }
};

/// The observations from a frame on.
[[nodiscard]] std::vector<Observation> since(int frame,
                                             const std::vector<Observation>& observations);

/// Fits these hypotheses to the observations of one point, by errors in the image.
///
/// The difference of the static error and the moving one is the likelihood ratio of "moving"
/// against "static": chi-square with 3 degrees of freedom for a static point. What moves
/// accelerates: the bend of its path over the image would pass for a motion along the line of
/// sight, so that velocity and point are those of a fit whose noise grows with the age of an
/// observation, unless the point may stand.
///
/// @param observations       ascending frames of the path; velocity and point are of its newest
/// @param speed_prior     standard deviation of speeds [m/s]; regularises short tracks
/// @return                nullopt with fewer than two observations or if the point is not in front
/// @see  Franke et al. 2005 ("6D-Vision"), in batch instead of recursively
[[nodiscard]] std::optional<PointMotion> fitMotion(const std::vector<Observation>& observations,
                                                   const CameraPath& path,
                                                   const StereoCamera& camera,
                                                   const ObservationNoise& noise,
                                                   double speed_prior);

/// A point of the image followed from frame to frame.
struct PointTrack {
  std::int64_t id = 0;                    ///< ascending in order of creation
  std::vector<Observation> observations;  ///< oldest first
  std::optional<PointMotion> motion;
  std::int64_t group = -1;  ///< of points on one moving object; -1: none, or static
};

/// Motion of a followed point.
enum class PointClass {
  kUnknown,   ///< observed too few times, or not significant
  kStatic,    ///< a static point explains its observations
  kMoving,    ///< only motion explains its observations
  kMismatch,  ///< neither does: it slid along an edge or to another object
};

/// Parameters of classifyPoint().
struct PointClassParams {
  int min_observations = 3;
  double significance = 30.0;  ///< likelihood ratio, chi-square with 3 degrees of freedom [-]
  double min_speed = 0.6;      ///< over the ground [m/s]
  double max_speed = 60.0;     ///< [m/s]
  double speed_sigmas = 3.0;   ///< speed over its standard deviation [-]
};

/// Classifies a fitted point by its motion over the ground.
///
/// @param up  unit normal of the ground, in the world of the path
[[nodiscard]] PointClass classifyPoint(const PointTrack& point, const Eigen::Vector3d& up,
                                       const PointClassParams& params);

/// Converts observations of earlier frames to disparities as they are measured in the newest one.
///
/// In right images that are turned back by different rotations static points would seem to move.
class TurnChange {
 public:
  explicit TurnChange(const StereoCamera& camera) : camera_(camera) {}

  /// Takes over what is undone in a new frame.
  ///
  /// @return  whether it differs from the frame before, so that observations are to be converted
  bool advance(const stereo::FrameContext& context);

  /// Observations whose disparity becomes less than 1 px are removed.
  void apply(std::vector<Observation>& observations) const;

 private:
  struct Undone {
    Eigen::Vector3d angles = Eigen::Vector3d::Zero();  ///< as FrameContext::rightTurn() [rad]
    double offset_px = 0.0;                            ///< as FrameContext::disparityOffset()
  };
  StereoCamera camera_;
  Undone before_, now_;
};

}  // namespace headway::detect
