// SPDX-License-Identifier: BSD-3-Clause
// Seconds and MRPT's time.
#pragma once

#include <headway/core/pose.h>
#include <mrpt/core/Clock.h>

#include <cmath>

namespace headway::io {

/// Converts seconds since the Unix epoch to MRPT's time; 0 s is valid, not INVALID_TIMESTAMP.
[[nodiscard]] inline mrpt::Clock::time_point mrptTime(Time time) {
  return mrpt::Clock::fromDouble(0.0) +
         mrpt::Clock::duration(std::llround(time * mrpt::Clock::period::den));
}

/// Inverse of mrptTime(), up to half a tick of MRPT's clock (50 ns) or the precision of a double.
[[nodiscard]] inline Time timeFrom(mrpt::Clock::time_point time) {
  return static_cast<double>((time - mrpt::Clock::fromDouble(0.0)).count()) /
         mrpt::Clock::period::den;
}

}  // namespace headway::io
