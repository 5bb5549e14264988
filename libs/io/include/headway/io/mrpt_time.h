#pragma once

#include <headway/core/pose.h>
#include <mrpt/core/Clock.h>

namespace headway::io {

/// MRPT's time of a time since the Unix epoch; 0 s is a valid time, not INVALID_TIMESTAMP.
[[nodiscard]] mrpt::Clock::time_point mrptTime(Time time);

/// Inverse of mrptTime, up to half a tick of MRPT's clock (50 ns) or what a double keeps of it.
[[nodiscard]] Time timeFrom(mrpt::Clock::time_point time);

}  // namespace headway::io
