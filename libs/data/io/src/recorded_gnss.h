// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/recorded_frame.h>
#include <mrpt/obs/CObservationGPS.h>

#include <map>
#include <optional>
#include <string>

#include "object_reader.h"

namespace headway::io {

/// Reads a CObservationGPS after its class name; of its messages, GGA is kept.
///
/// @throws BrokenObject
[[nodiscard]] mrpt::obs::CObservation::Ptr readGnss(ObjectReader& in);

/// The fix of its GGA message; nullopt without a usable one.
///
/// @param skipped  counts "gnss_no_position", "gnss_without_fix", "gnss_bad_pose"
[[nodiscard]] std::optional<GnssFix> fixFrom(const mrpt::obs::CObservationGPS& observation,
                                             std::map<std::string, std::size_t>& skipped);

}  // namespace headway::io
