// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/img/TCamera.h>
#include <mrpt/poses/CPose2D.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DPDFGaussian.h>
#include <mrpt/poses/CPose3DQuat.h>

#include "object_reader.h"

namespace headway::io {

// Poses and cameras as objects within observations; each throws BrokenObject if it cannot be read.

[[nodiscard]] mrpt::poses::CPose2D readPose2D(ObjectReader& in);              ///< versions 0 and 1
[[nodiscard]] mrpt::poses::CPose3D readPose3D(ObjectReader& in);              ///< versions 0 to 3
[[nodiscard]] mrpt::poses::CPose3DQuat readPoseQuat(ObjectReader& in);        ///< version 0
[[nodiscard]] mrpt::poses::CPose3DPDFGaussian readPosePdf(ObjectReader& in);  ///< version 1
[[nodiscard]] mrpt::img::TCamera readCamera(ObjectReader& in);                ///< versions 0 to 6

/// Sets the intrinsic parameters from a 3x3 matrix, as cameras of old versions store them.
void setIntrinsics(mrpt::img::TCamera& camera, const std::vector<double>& matrix);

}  // namespace headway::io
