// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <Eigen/Core>
#include <vector>

#include "bundle_solver.h"

namespace headway::slam {

/// A measured motion's weighted residual and its derivatives by the tangents of both camera poses.
struct MotionTerms {
  Eigen::Matrix<double, 6, 1> residual;
  Eigen::Matrix<double, 6, 6> by_a;
  Eigen::Matrix<double, 6, 6> by_b;
};

/// Cauchy's loss of a measured motion: it stays small where the wheels slip, unlike a square.
[[nodiscard]] double motionLoss(const BundleProblem::Motion& motion, const std::vector<Pose>& poses,
                                const Pose& T_robot_cam);

/// The motion linearised about the poses, scaled by the root of the loss's weight.
[[nodiscard]] MotionTerms linearised(const BundleProblem::Motion& motion,
                                     const std::vector<Pose>& poses, const Pose& T_robot_cam);

}  // namespace headway::slam
