// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>

#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway {

/// Regions of a left image on moving objects, excluded from the landmarks.
struct MovingRegions {
  std::vector<Box2d> boxes;   ///< [px], left rectified image
  std::vector<Box2d> unsure;  ///< of movable objects that may be static [px]
  cv::Mat mask;               ///< 8-bit, non-zero on moving objects; empty: boxes only
};

}  // namespace headway
