#pragma once

#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>

namespace headway::io {

template <typename Kind>
[[nodiscard]] bool isKind(const mrpt::obs::CObservation& observation) {
  return dynamic_cast<const Kind*>(&observation) != nullptr;
}

[[nodiscard]] inline bool isImage(const mrpt::obs::CObservation& observation) {
  return isKind<mrpt::obs::CObservationStereoImages>(observation) ||
         isKind<mrpt::obs::CObservationImage>(observation);
}

/// Whether it tells how the robot moves.
[[nodiscard]] inline bool isMotion(const mrpt::obs::CObservation& observation) {
  return isKind<mrpt::obs::CObservationOdometry>(observation) ||
         isKind<mrpt::obs::CObservationIMU>(observation);
}

}  // namespace headway::io
