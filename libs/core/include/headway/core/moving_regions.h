#pragma once

#include <headway/core/detection.h>

#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway {

/// Parts of a left image that belong to moving things: no landmark may come from them.
struct MovingRegions {
  std::vector<Box2d> boxes;   ///< [px], left rectified image
  std::vector<Box2d> unsure;  ///< of things that can move, and may stand [px]
  cv::Mat mask;               ///< 8-bit, non-zero where something moves; empty: boxes alone
};

}  // namespace headway
