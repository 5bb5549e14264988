// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace headway::plot {

/// Smallest step of 1, 2 or 5 times a power of ten that divides `range` into at most `max_parts`.
[[nodiscard]] double tickStep(double range, double max_parts);

/// Largest length of 1, 2 or 5 times a power of ten that does not exceed `max_length`: for scale
/// bars.
///
/// @param max_length  above 0
[[nodiscard]] double scaleBarLength(double max_length);

/// A tick's value with as many decimals as its step needs.
[[nodiscard]] std::string tickText(double value, double step);

}  // namespace headway::plot
