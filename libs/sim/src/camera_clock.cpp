#include "camera_clock.h"

#include <algorithm>

namespace headway::sim {

CameraClock::Beat CameraClock::next() {
  const double sigma = params_.jitter_s;
  const double jitter = std::clamp(sigma * random_.normal(), -3.0 * sigma, 3.0 * sigma);
  const auto beat = static_cast<double>(beats_++);
  if (beat == 0.0) return {};
  return {beat / params_.rate_hz + jitter, random_.chance(params_.drop_ratio)};
}

}  // namespace headway::sim
