// SPDX-License-Identifier: BSD-3-Clause
#include "motion_classifier.h"

namespace headway::objects {

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
