// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

namespace headway::slam {

/// Covariance of T_a_c = T_a_b T_b_c from those of its factors, whose errors are independent.
///
/// @param T_b_c  with the covariance `of_bc`; a pose that is exactly known has covariance 0
/// @see          Barfoot & Furgale 2014, first order; perturbations act on the right
[[nodiscard]] PoseCovariance composedCovariance(const PoseCovariance& of_ab, const Pose& T_b_c,
                                                const PoseCovariance& of_bc);

/// Standard deviation of a position, mean of the axes [m].
[[nodiscard]] double positionSigma(const PoseCovariance& covariance);

/// Standard deviation of a rotation, mean of the axes [rad].
[[nodiscard]] double rotationSigma(const PoseCovariance& covariance);

}  // namespace headway::slam
