// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

namespace headway::map {

/// A pose with covariance in MRPT's parameters (x, y, z, yaw, pitch, roll), in the map frame.
///
/// headway's perturbation is on the right, T exp(xi); to first order a rotation in the robot's axes
/// changes the angles by the inverse of MRPT's Euler rates. These are unbounded near pitch =
/// +-90 deg, where the angles are not defined.
[[nodiscard]] mrpt::poses::CPose3DPDFGaussian toMrptPdf(const Pose& T_map_robot,
                                                        const PoseCovariance& covariance);

}  // namespace headway::map
