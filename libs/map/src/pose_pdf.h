#pragma once

#include <headway/core/pose.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>

namespace headway::map {

/// A pose with covariance as MRPT has it: over (x, y, z, yaw, pitch, roll), all in the map frame.
///
/// Ours perturbs on the right, T exp(xi); to first order a turn w seen from the body changes the
/// angles by the inverse of MRPT's Euler rates. Near pitch = +-90 deg those grow without bound, as
/// the angles themselves lose their meaning there.
[[nodiscard]] mrpt::poses::CPose3DPDFGaussian toMrptPdf(const Pose& T_map_robot,
                                                        const PoseCovariance& covariance);

}  // namespace headway::map
