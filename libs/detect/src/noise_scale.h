#pragma once

#include <vector>

#include "point_follower.h"

namespace headway::detect {

/// How much greater or smaller the errors of sightings are than assumed: images differ.
///
/// Taken from the points that are no part of anything that moves: the median of how well standing
/// explains them, smoothed over the frames.
class NoiseScale {
 public:
  void update(const std::vector<PointTrack>& points);
  /// True errors over those assumed [-].
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_ = 1.0;
};

}  // namespace headway::detect
