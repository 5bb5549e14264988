// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>

namespace headway::io {

// How accurate a position is, by what NMEA's GGA states: the kind of fix and the horizontal
// dilution of precision.

/// Standard deviation of each horizontal axis [m]; nullopt for what is no measured position:
/// quality 0 (no fix), 7 and 8 (typed in, simulated), and unknown ones, or a dilution above 100.
///
/// @param hdop  horizontal dilution of precision; nullopt, 0 or NaN: 1.5
[[nodiscard]] std::optional<double> gnssSigma(std::uint8_t quality, std::optional<double> hdop);

/// The dilution of precision with which gnssSigma() returns `sigma_m`; nullopt without a fix.
[[nodiscard]] std::optional<double> hdopOf(std::uint8_t quality, double sigma_m);

}  // namespace headway::io
