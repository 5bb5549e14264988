// SPDX-License-Identifier: BSD-3-Clause
#include "heading_evidence.h"

#include <headway/core/pose.h>

#include <algorithm>
#include <cmath>

namespace headway::objects {
namespace {

// log-odds of one detection
double weightOf(const HeadingParams& params) {
  return std::log((1.0 - params.flip_probability) / params.flip_probability);
}

}  // namespace

HeadingEvidence::HeadingEvidence(const HeadingParams& params)
    : params_(params), log_odds_(weightOf(params)) {}

double HeadingEvidence::unflipped(double measured, double yaw) {
  const bool agrees = std::abs(wrapAngle(measured - yaw)) <= 0.5 * M_PI;
  add(agrees ? weightOf(params_) : -weightOf(params_));
  return agrees ? measured : wrapAngle(measured + M_PI);
}

void HeadingEvidence::addMotion(double cosine) {
  constexpr double kSideways = 0.5;  // motion more than 60 degrees off is no evidence
  if (std::abs(cosine) < kSideways) return;
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

}  // namespace headway::objects
