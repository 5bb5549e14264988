// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>

#include <optional>

#include "bundle_solver.h"
#include "sparse_map.h"

namespace headway::slam {

/// Sums up wheel odometry from one keyframe to the next.
class KeyframeOdometry {
 public:
  /// @param use  false: there are no links
  explicit KeyframeOdometry(bool use) : use_(use) {}

  /// Adds the motion since the frame before; without one there is no link until the next restart.
  void add(const MotionPrior& prior);
  /// The motion since the last keyframe; nullopt if it is not known throughout.
  [[nodiscard]] const std::optional<OdometryLink>& link() const { return link_; }
  /// Starts anew at a keyframe, or at a frame that belongs to it.
  void restartAt(KeyframeId keyframe);

 private:
  bool use_ = true;
  std::optional<OdometryLink> link_;
};

/// Standard deviations of a link for a BundleProblem::Motion: (translation [m], rotation [rad]).
///
/// Wheels measure motion in the plane that the robot stands on, so the other components have the
/// uncertainty of the ground's slope.
[[nodiscard]] Eigen::Matrix<double, 6, 1> sigmaOf(const OdometryLink& link);

/// The same as the covariance of a pose that was predicted by the link (right perturbation). A
/// wrong direction displaces half of the path.
[[nodiscard]] PoseCovariance covarianceOf(const OdometryLink& link);

}  // namespace headway::slam
