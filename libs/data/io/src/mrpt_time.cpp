// SPDX-License-Identifier: BSD-3-Clause
#include <headway/io/mrpt_time.h>

#include <cmath>

namespace headway::io {
namespace {

constexpr double kTicksPerSecond = 1e7;

}  // namespace

mrpt::Clock::time_point mrptTime(Time time) {
  return mrpt::Clock::fromDouble(0.0) + mrpt::Clock::duration(std::llround(time * kTicksPerSecond));
}

Time timeFrom(mrpt::Clock::time_point time) {
  return static_cast<double>((time - mrpt::Clock::fromDouble(0.0)).count()) / kTicksPerSecond;
}

}  // namespace headway::io
