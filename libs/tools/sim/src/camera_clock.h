// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>
#include <headway/sim/sim_params.h>

#include <algorithm>
#include <cstdint>

namespace headway::sim {

/// When the camera takes its frames: on the beat, but for jitter and for frames that are lost.
///
/// The first frame is what time is counted from: it comes at 0 and is never lost.
class CameraClock {
 public:
  struct Beat {
    double time_s = 0.0;  ///< middle of the exposure, since the first frame [s]
    bool lost = false;
  };

  CameraClock(const CameraParams& params, std::uint64_t seed) : params_(params), random_(seed) {}

  [[nodiscard]] Beat next() {
    const double sigma = params_.jitter_s;
    const double jitter = std::clamp(sigma * random_.normal(), -3.0 * sigma, 3.0 * sigma);
    const auto beat = static_cast<double>(beats_++);
    if (beat == 0.0) return {};
    return {beat / params_.rate_hz + jitter, random_.chance(params_.drop_ratio)};
  }

 private:
  CameraParams params_;
  Random random_;
  std::size_t beats_ = 0;  ///< so far, lost frames included
};

}  // namespace headway::sim
