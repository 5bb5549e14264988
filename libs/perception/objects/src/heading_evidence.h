// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/objects/objects_params.h>

namespace headway::objects {

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

}  // namespace headway::objects
