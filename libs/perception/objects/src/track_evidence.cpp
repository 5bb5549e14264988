// SPDX-License-Identifier: BSD-3-Clause
// What a track's detections say together: its class, the sense of its heading, whether it moves.
#include "track_evidence.h"

#include <headway/core/pose.h>

#include <algorithm>
#include <cmath>

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

// log-odds of one detection
double weightOf(const HeadingParams& params) {
  return std::log((1.0 - params.flip_probability) / params.flip_probability);
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

HeadingEvidence::HeadingEvidence(const HeadingParams& params)
    : params_(params), log_odds_(weightOf(params)) {}

double HeadingEvidence::unflipped(double measured, double yaw) {
  const bool agrees = std::abs(wrapAngle(measured - yaw)) <= 0.5 * M_PI;
  add(agrees ? weightOf(params_) : -weightOf(params_));
  return agrees ? measured : wrapAngle(measured + M_PI);
}

void HeadingEvidence::addMotion(double cosine) {
  if (std::abs(cosine) < 0.5) return;  // motion more than 60 degrees off is no evidence
  add(std::copysign(weightOf(params_), cosine));
}

bool HeadingEvidence::turnsRound() {
  if (log_odds_ > -params_.flip_log_odds) return false;
  log_odds_ = -log_odds_;
  return true;
}

void HeadingEvidence::add(double log_odds) {
  log_odds_ =
      std::clamp(log_odds_ + log_odds, -params_.max_flip_log_odds, params_.max_flip_log_odds);
}

void MotionClassifier::update(Time time, double speed, double speed_sigma, MotionGroup group) {
  if (speed > params_.static_speed_mps.of(group)) last_fast_ = time;
  sure_ = params_.significance * speed_sigma < params_.moving_speed_mps.of(group);
  if (moving_) {
    moving_ = time - last_fast_ < params_.static_time_s;
  } else {
    moving_ =
        speed > params_.moving_speed_mps.of(group) && speed > params_.significance * speed_sigma;
  }
}

}  // namespace headway::objects
