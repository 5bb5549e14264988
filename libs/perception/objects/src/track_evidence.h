// SPDX-License-Identifier: BSD-3-Clause
// What a track's detections say together: its class, the sense of its heading, whether it moves.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>
#include <headway/objects/per_class.h>

#include <array>

#include "measurement_model.h"

namespace headway::objects {

/// Votes of a track's detections for its class.
///
/// A classifier's class is known at once. One derived from size and speed is provisional: it is
/// wrong in one of three frames, and successive frames err together, so that half of their
/// information counts. Three votes ahead of every other kind of motion leave it a chance of 1 in 9.
class ClassEvidence {
 public:
  explicit ClassEvidence(const MeasuredBox& first) : assumed_(first.object_class) { add(first); }

  void add(const MeasuredBox& detection);

  /// The class of most votes, of which the track's motion parameters are.
  [[nodiscard]] ObjectClass assumed() const { return assumed_; }
  /// The same, once it is known; Unknown before.
  [[nodiscard]] ObjectClass known() const { return is_known_ ? assumed_ : ObjectClass::kUnknown; }

 private:
  [[nodiscard]] bool leads() const;

  ObjectClass assumed_;
  bool is_known_ = false;
  std::array<double, kObjectClassCount> votes_{};
};

/// Accumulates evidence over frames for or against a track's heading being reversed.
///
/// Each detection, and the path of a moving object, adds log-odds for or against the heading. A
/// single flipped detection, or a few in a row, do not reverse a track.
class HeadingEvidence {
 public:
  explicit HeadingEvidence(const HeadingParams& params);

  /// The measured heading or its opposite, whichever is nearer to `yaw` [rad].
  ///
  /// Adds the result to the evidence.
  [[nodiscard]] double unflipped(double measured, double yaw);

  /// Adds the direction of motion to the evidence.
  ///
  /// @param cosine  of the angle between heading and velocity
  void addMotion(double cosine);

  /// Whether the track is to be reversed. If so the evidence is negated, for the new heading.
  [[nodiscard]] bool turnsRound();

 private:
  void add(double log_odds);

  HeadingParams params_;
  double log_odds_;  ///< that the heading is correct
};

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
