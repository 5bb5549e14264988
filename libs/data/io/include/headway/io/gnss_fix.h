// SPDX-License-Identifier: BSD-3-Clause
// Positions of satellite receivers as recorded, and how accurate they are by what NMEA's GGA
// states.
#pragma once

#include <headway/core/recorded_frame.h>
#include <mrpt/obs/CObservationGPS.h>

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace headway::io {

/// Standard deviation of each horizontal axis [m] by the kind of fix and the horizontal dilution of
/// precision; nullopt for what is no measured position:
/// quality 0 (no fix), 7 and 8 (typed in, simulated), and unknown ones, or a dilution above 100.
///
/// @param hdop  horizontal dilution of precision; nullopt, 0 or NaN: 1.5
[[nodiscard]] std::optional<double> gnssSigma(std::uint8_t quality, std::optional<double> hdop);

/// The dilution of precision with which gnssSigma() returns `sigma_m`; nullopt without a fix.
[[nodiscard]] std::optional<double> hdopOf(std::uint8_t quality, double sigma_m);

/// The fix of its GGA message; nullopt without a usable one.
///
/// @param skipped  counts "gnss_no_position", "gnss_without_fix", "gnss_bad_pose"
[[nodiscard]] std::optional<GnssFix> fixFrom(const mrpt::obs::CObservationGPS& observation,
                                             std::map<std::string, std::size_t>& skipped);

}  // namespace headway::io
