#pragma once

#include <headway/core/detection.h>

#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway {

/// Regions of a left image on moving objects: no landmark is taken from them.
struct MovingRegions {
  std::vector<Box2d> boxes;   ///< [px], left rectified image
  std::vector<Box2d> unsure;  ///< of movable objects that may be static [px]
  cv::Mat mask;               ///< 8-bit, non-zero on moving objects; empty: boxes alone
};

}  // namespace headway
