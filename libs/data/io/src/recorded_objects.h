// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose2D.h>

#include <optional>
#include <string>

#include "object_reader.h"

namespace headway::io {

/// Whether readObservation() reads observations of this class (without namespace). All others are
/// skipped: MRPT would read them without limits of size and nesting.
[[nodiscard]] bool isReadClass(const std::string& class_name);

/// Reads the values of an observation after its class name: version, values and end mark.
///
/// Classes and versions are those that MRPT 2.5.8 reads: CObservationStereoImages 0-6,
/// CObservationImage 0-4, CObservationIMU 0-4, CObservationOdometry 0-2, CObservation2DRangeScan
/// 0-7, CObservation3DRangeScan 0-10, CObservationRobotPose 0-1; and CObservationObjectDetections 0
/// of this library. Embedded images are decoded; those that are broken are empty.
///
/// @param class_name  for which isReadClass() is true
/// @throws BrokenObject if it cannot be read
[[nodiscard]] mrpt::obs::CObservation::Ptr readObservation(const std::string& class_name,
                                                           ObjectReader& in);

/// Reads the values of a CActionRobotMovement2D, versions 2 to 7, after its class name.
///
/// @return the increment of odometry; nullopt if the movement was estimated in another way, and the
///         end mark is then not read
/// @throws BrokenObject if it cannot be read
[[nodiscard]] std::optional<mrpt::poses::CPose2D> readMovement(ObjectReader& in);

}  // namespace headway::io
