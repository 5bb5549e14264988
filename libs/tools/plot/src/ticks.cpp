// SPDX-License-Identifier: BSD-3-Clause
#include <headway/plot/ticks.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace headway::plot {

double tickStep(double range, double max_parts) {
  const double min_step = range / max_parts;
  const double power = std::pow(10.0, std::floor(std::log10(min_step)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= min_step) return factor * power;
  }
  return 10.0 * power;
}

double scaleBarLength(double max_length) {
  const double power = std::pow(10.0, std::floor(std::log10(max_length)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= max_length) return factor * power;
  }
  return power;
}

std::string tickText(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const double shown = std::abs(value) < 1e-9 * step ? 0.0 : value;  // no "-0.0"
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, shown);
  return text.data();
}

}  // namespace headway::plot
