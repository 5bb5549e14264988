// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "time_check.h"

namespace headway::import {

/// How far a camera has turned between two images.
struct TurnStep {
  Time begin = 0.0, end = 0.0;
  double angle = 0.0;  ///< [rad], not negative
};

struct ClockOffset {
  double offset_s = 0.0;  ///< of the inertial sensor's times against the images'
  double correlation = 0.0;
};

/// The offset at which the amounts of the turns, camera and gyroscope, correlate best; whatever
/// the mounting of both. nullopt if they turn too little, or do not correlate.
[[nodiscard]] std::optional<ClockOffset> clockOffset(const std::vector<TurnStep>& steps,
                                                     const std::vector<TurnSample>& samples);

}  // namespace headway::import
