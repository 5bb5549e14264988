// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>

namespace headway::objects {

/// Classifies an object as moving or static, with hysteresis.
///
/// It is moving once its speed is high and significant, and static again only after some time below
/// a lower speed.
class MotionClassifier {
 public:
  explicit MotionClassifier(const MotionClassParams& params) : params_(params) {}

  /// @param speed        [m/s]
  /// @param speed_sigma  its standard deviation [m/s]
  void update(Time time, double speed, double speed_sigma, MotionGroup group);

  /// A detector that would measure the object's motion found none.
  void setStatic() { moving_ = false; }

  [[nodiscard]] bool moving() const { return moving_; }
  /// Whether its velocity is known well enough to call it static.
  [[nodiscard]] bool standing() const { return !moving_ && sure_; }
  [[nodiscard]] MotionState state() const {
    if (moving_) return MotionState::kMoving;
    return sure_ ? MotionState::kStatic : MotionState::kUnknown;
  }

 private:
  MotionClassParams params_;
  bool moving_ = false;
  bool sure_ = false;
  Time last_fast_ = 0.0;  ///< when it last was faster than static_speed_mps
};

}  // namespace headway::objects
