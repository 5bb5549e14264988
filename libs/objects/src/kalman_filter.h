#pragma once

#include <headway/objects/objects_params.h>

#include <Eigen/Core>

#include "measured_box.h"

namespace headway::objects {

/// How a quantity, its rate and its acceleration go on over one time step (Singer's model).
///
/// The acceleration fades with a correlation time and is driven by noise; with it the rate settles
/// instead of running away over long gaps.
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
/// The six are the place x, y, z [m], the heading yaw [rad], and the footprint's length and width
/// [m]; the height, which no motion touches, is averaged beside them. All are in the map frame.
/// x and y share one noise ellipse and are filtered together; nothing couples the others, so the
/// 18x18 covariance falls into one block of 6x6 and four of 3x3, and is kept as these.
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

  /// Carries the state on by one step.
  ///
  /// @param standing  the object is known to stand: it hardly accelerates
  void predict(const Transition& transition, bool standing);

  /// Takes in a measured place, velocity and footprint.
  void updatePlace(const MeasuredBox& measured);
  void updateVelocity(const GroundVelocity& measured);
  void updateSize(const Eigen::Vector3d& size);

  /// Takes in a heading; `measured` must lie within half a turn of yaw().
  void updateYaw(double measured);
  /// Heading of a standing object: the mean of `count` measurements so far, and no turning.
  void averageYaw(double measured, double count);
  /// The other way round: what was taken for the front is the back.
  void turnRound();

  [[nodiscard]] Eigen::Vector3d position() const { return {x_.mean(0), y_.mean(0), z_.mean(0)}; }
  [[nodiscard]] Eigen::Vector3d velocity() const { return {x_.mean(1), y_.mean(1), z_.mean(1)}; }
  [[nodiscard]] Eigen::Matrix2d positionCovariance() const { return planar(0); }
  [[nodiscard]] Eigen::Matrix2d velocityCovariance() const { return planar(1); }
  [[nodiscard]] double verticalVariance() const { return z_.covariance(0, 0); }
  [[nodiscard]] double yaw() const { return yaw_.mean(0); }  ///< in (-pi, pi]
  [[nodiscard]] double yawRate() const { return yaw_.mean(1); }
  [[nodiscard]] Eigen::Vector3d size() const { return {length_.mean(0), width_.mean(0), height_}; }

 private:
  [[nodiscard]] Eigen::Matrix2d planar(int derivative) const;
  void updatePlanar(int derivative, const Eigen::Vector2d& measured,
                    const Eigen::Matrix2d& covariance);

  FilterParams params_;
  double acceleration_sigma_;
  Chain x_, y_;  ///< with cross_xy_: one 6x6 block
  Eigen::Matrix3d cross_xy_ = Eigen::Matrix3d::Zero();
  Chain z_, yaw_, length_, width_;
  double height_;
  int sizes_seen_ = 1;
};

}  // namespace headway::objects
