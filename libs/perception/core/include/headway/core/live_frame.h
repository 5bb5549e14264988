// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/recorded_frame.h>

#include <chrono>
#include <functional>

namespace headway {

/// Seconds of a clock that never goes back; tests replace it.
using MonotonicClock = std::function<double()>;

/// Seconds of the machine's monotonic clock, of unspecified origin.
[[nodiscard]] inline double monotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A frame of live sensors.
struct LiveFrame {
  RecordedFrame frame;
  double arrival_s = 0.0;  ///< when its second image arrived, by a MonotonicClock [s]
};

}  // namespace headway
