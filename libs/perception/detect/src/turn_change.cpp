// SPDX-License-Identifier: BSD-3-Clause
#include "turn_change.h"

#include <headway/stereo/rectification.h>

#include <algorithm>

namespace headway::detect {

bool TurnChange::advance(const stereo::FrameContext& context) {
  before_ = now_;
  now_ = {context.rightTurn(), context.disparityOffset()};
  return now_.angles != before_.angles;
}

void TurnChange::apply(std::vector<Observation>& observations) const {
  constexpr double kMinConverted = 1.0;  // [px]
  for (Observation& one : observations) {
    const double measured = one.uvd.z() + before_.offset_px;
    one.uvd.z() =
        stereo::turnedDisparity(one.uvd.head<2>(), measured, before_.angles, now_.angles, camera_) -
        now_.offset_px;
  }
  const auto is_too_far = [](const Observation& one) { return one.uvd.z() < kMinConverted; };
  observations.erase(std::remove_if(observations.begin(), observations.end(), is_too_far),
                     observations.end());
}

}  // namespace headway::detect
