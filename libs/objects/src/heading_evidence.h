#pragma once

#include <headway/objects/objects_params.h>

namespace headway::objects {

/// Weighs over frames whether a track's front is its back.
///
/// Every detection that faces the same way speaks for the heading, every one that faces the other
/// way against it, and so does the path of a moving object. Only evidence gathered over frames
/// turns a track; one flipped detection, or several in a row, do not.
class HeadingEvidence {
 public:
  explicit HeadingEvidence(const HeadingParams& params);

  /// The measured heading or its opposite, whichever lies nearer to `yaw` [rad].
  ///
  /// Counts which of the two it was.
  [[nodiscard]] double unflipped(double measured, double yaw);

  /// Counts the direction of motion for or against the heading.
  ///
  /// @param cosine  of the angle between heading and velocity
  void addMotion(double cosine);

  /// Whether the evidence wants the track turned round. If so it then speaks for the new heading.
  [[nodiscard]] bool turnsRound();

 private:
  void add(double log_odds);

  HeadingParams params_;
  double log_odds_;  ///< that the heading is right
};

}  // namespace headway::objects
