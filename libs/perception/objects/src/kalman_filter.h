// SPDX-License-Identifier: BSD-3-Clause
// The filter of a track's state (Sec. III-C2).
#pragma once

#include <headway/objects/objects_params.h>

#include <Eigen/Core>

#include "measurement_model.h"

namespace headway::objects {

/// Transition of a quantity, its rate and its acceleration over one time step (Singer's model).
///
/// The acceleration decays with a correlation time and is driven by noise, so that the rate remains
/// bounded over long gaps.
///
/// @see Singer 1970, "Estimating optimal tracking filter performance"; Bar-Shalom et al. 2001, 6.2
struct Transition {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();  ///< of (value, rate, acceleration)
  Eigen::Matrix3d Q = Eigen::Matrix3d::Zero();      ///< for accelerations of standard deviation 1

  /// @param dt_s    step >= 0 [s]
  /// @param time_s  correlation time of the acceleration > 0 [s]
  Transition(double dt_s, double time_s);
};

/// The paper's linear filter of 18 states: six measured quantities, each with its rate and its
/// acceleration (Sec. III-C2).
///
/// The six are the position x, y, z [m], the heading yaw [rad], and the footprint's length and
/// width [m]; the height, independent of motion, is averaged separately. All are in the map frame.
/// x and y have correlated noise and are filtered together; the others are independent, so that the
/// 18x18 covariance consists of one block of 6x6 and four of 3x3, and is stored as these.
class KalmanFilter {
 public:
  /// One quantity (value, rate, acceleration) with its covariance.
  struct Chain {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

    void predict(const Transition& transition, double sigma);
    void update(double measured, double variance);
  };

  KalmanFilter(const MeasuredBox& first, const FilterParams& params);

  /// Predicts the state by one step.
  ///
  /// @param standing  the object is classified as static: small accelerations
  void predict(const Transition& transition, bool standing);

  /// Updates the state by a measured position, velocity and footprint.
  void updatePlace(const MeasuredBox& measured);
  void updateVelocity(const GroundVelocity& measured);
  void updateSize(const MeasuredBox& measured);

  /// Updates the state by a heading; `measured` must be within pi of yaw() [rad].
  void updateYaw(double measured, double sigma_rad);
  /// Heading of a static object: the mean of `count` measurements so far, without turn rate.
  void averageYaw(double measured, double count);
  /// Reverses the heading by 180 degrees.
  void turnRound();

  [[nodiscard]] Eigen::Vector3d position() const { return {x_.mean(0), y_.mean(0), z_.mean(0)}; }
  [[nodiscard]] Eigen::Vector3d velocity() const { return {x_.mean(1), y_.mean(1), z_.mean(1)}; }
  [[nodiscard]] Eigen::Matrix2d positionCovariance() const { return planar(kPlace); }
  [[nodiscard]] Eigen::Matrix2d velocityCovariance() const { return planar(kRate); }
  [[nodiscard]] double verticalVariance() const { return z_.covariance(0, 0); }
  [[nodiscard]] double yaw() const { return yaw_.mean(0); }  ///< in (-pi, pi]
  [[nodiscard]] double yawRate() const { return yaw_.mean(1); }
  [[nodiscard]] Eigen::Vector3d size() const { return {length_.mean(0), width_.mean(0), height_}; }

 private:
  // What is measured of a chain.
  inline static const Eigen::RowVector3d kPlace{1.0, 0.0, 0.0}, kRate{0.0, 1.0, 0.0};

  /// Covariance of what a row takes of each chain of x and y.
  [[nodiscard]] Eigen::Matrix2d planar(const Eigen::RowVector3d& row) const;
  void updatePlanar(const Eigen::RowVector3d& row, const Eigen::Vector2d& measured,
                    const Eigen::Matrix2d& covariance);

  FilterParams params_;
  double acceleration_sigma_;
  Chain x_, y_;  ///< with cross_xy_: one 6x6 block
  Eigen::Matrix3d cross_xy_ = Eigen::Matrix3d::Zero();
  Chain z_, yaw_, length_, width_;
  double height_;
  double height_weight_;  ///< sum of the inverse variances of the heights averaged [1/m^2]
};

}  // namespace headway::objects
