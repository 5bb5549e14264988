#include "motion_classifier.h"

namespace headway::objects {

void MotionClassifier::update(Time time, double speed, double speed_sigma, MotionGroup group) {
  if (speed > params_.still_speed.of(group)) last_fast_ = time;
  sure_ = params_.significance * speed_sigma < params_.moving_speed.of(group);
  if (moving_) {
    moving_ = time - last_fast_ < params_.still_time_s;
  } else {
    moving_ = speed > params_.moving_speed.of(group) && speed > params_.significance * speed_sigma;
  }
}

}  // namespace headway::objects
