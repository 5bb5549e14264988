// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>

namespace headway {

double percentile(std::vector<double> samples, double fraction) {
  if (samples.empty()) return 0.0;
  const auto count = static_cast<double>(samples.size());
  const double rank = std::clamp(std::ceil(fraction * count), 1.0, count);
  const auto nth = samples.begin() + static_cast<std::ptrdiff_t>(rank - 1.0);
  std::nth_element(samples.begin(), nth, samples.end());
  return *nth;
}

double median(std::vector<double> samples) {
  if (samples.empty()) return 0.0;
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  return *middle;
}

}  // namespace headway
