#pragma once

#include <vector>

namespace headway {

[[nodiscard]] constexpr double square(double x) { return x * x; }

/// Value below which the ratio `fraction` of the samples lies (nearest rank); 0 if there are none.
[[nodiscard]] double percentile(std::vector<double> samples, double fraction);

/// Median of the sorted samples, the upper of the two where their number is even; 0 if there are
/// none.
[[nodiscard]] double median(std::vector<double> samples);

}  // namespace headway
