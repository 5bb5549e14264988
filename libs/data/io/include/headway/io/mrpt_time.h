// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <mrpt/core/Clock.h>

namespace headway::io {

/// Converts seconds since the Unix epoch to MRPT's time; 0 s is valid, not INVALID_TIMESTAMP.
[[nodiscard]] mrpt::Clock::time_point mrptTime(Time time);

/// Inverse of mrptTime(), up to half a tick of MRPT's clock (50 ns) or the precision of a double.
[[nodiscard]] Time timeFrom(mrpt::Clock::time_point time);

}  // namespace headway::io
