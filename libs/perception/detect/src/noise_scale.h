// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "point_follower.h"

namespace headway::detect {

/// Ratio of the errors of image observations to those assumed, which depends on the images.
///
/// The median fit of static points, smoothed over the frames. Not objects::NoiseScale, which scales
/// the covariances of detections by a tracker's innovations.
class NoiseScale {
 public:
  void update(const std::vector<PointTrack>& points);
  /// True errors over those assumed [-].
  [[nodiscard]] double value() const { return value_; }

 private:
  double value_ = 1.0;
};

}  // namespace headway::detect
