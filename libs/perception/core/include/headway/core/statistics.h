// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

namespace headway {

[[nodiscard]] constexpr double square(double x) { return x * x; }

/// Percentile of the samples by nearest rank, `fraction` in [0, 1]; 0 if there are none.
[[nodiscard]] double percentile(std::vector<double> samples, double fraction);

/// Median of the samples in any order, the upper one of an even number; 0 if there are
/// none.
[[nodiscard]] double median(std::vector<double> samples);

}  // namespace headway
