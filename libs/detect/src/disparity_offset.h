#pragma once

#include <vector>

#include "point_classification.h"

namespace headway::detect {

/// How much all disparities are off by, as still points tell while the camera moves.
///
/// Rectification that is off by a small angle, or images that were not taken at the same instant
/// in a turn, shift all disparities alike: then near and far points ask for different camera
/// speeds, and a fence at the wayside seems to creep. Estimated as a slow random walk.
class DisparityOffset {
 public:
  /// Takes in the points of one frame, as fitted; moving and mismatched ones have no say.
  void update(const std::vector<PointTrack>& points, const std::vector<PointClass>& classes);

  [[nodiscard]] double value() const { return value_; }  ///< measured less true disparity [px]

 private:
  double value_ = 0.0;
  double variance_ = 0.25;  ///< [px^2]; rectified pairs are good to half a pixel
};

}  // namespace headway::detect
