// SPDX-License-Identifier: BSD-3-Clause
#include "class_evidence.h"

#include <algorithm>

namespace headway::objects {
namespace {

constexpr double kRiderVotes = 3.0;       // a bicycle is often hidden, but seldom a false detection
constexpr double kVotesAhead = 3.0;       // of a provisional class, until it is known
constexpr double kFastestWalk_mps = 3.5;  // faster persons ride, though their bicycle is hidden

ObjectClass seenClass(const MeasuredBox& detection, bool is_classified) {
  const bool is_fast = detection.object_class == ObjectClass::kPedestrian &&
                       detection.evidence.motion && detection.velocity &&
                       detection.velocity->value.norm() > kFastestWalk_mps;
  return is_classified && is_fast ? ObjectClass::kCyclist : detection.object_class;
}

}  // namespace

void ClassEvidence::add(const MeasuredBox& detection) {
  const bool is_provisional = detection.classIsProvisional();
  if (detection.evidence.appearance && is_provisional) return;  // the class is this track's own
  const bool is_classified = detection.evidence.classifier && detection.evidence.classifier_tested;
  const ObjectClass seen = seenClass(detection, is_classified);
  const bool is_rider = is_classified && seen == ObjectClass::kCyclist;
  votes_[static_cast<std::size_t>(seen)] += is_rider ? kRiderVotes : 1.0;
  const auto best = std::max_element(votes_.begin(), votes_.end());
  if (*best > votes_[static_cast<std::size_t>(assumed_)]) {
    assumed_ = static_cast<ObjectClass>(best - votes_.begin());
  }
  is_known_ = is_known_ || !is_provisional || leads();
}

bool ClassEvidence::leads() const {
  std::array<double, kMotionGroupCount> groups{};
  for (std::size_t i = 0; i < votes_.size(); ++i) {
    groups[static_cast<std::size_t>(motionGroupOf(static_cast<ObjectClass>(i)))] += votes_[i];
  }
  const auto own = static_cast<std::size_t>(motionGroupOf(assumed_));
  const double votes = groups[own];
  groups[own] = 0.0;
  return votes - *std::max_element(groups.begin(), groups.end()) >= kVotesAhead;
}

}  // namespace headway::objects
