// SPDX-License-Identifier: BSD-3-Clause
// Regions of an image that belong to moving objects.
#pragma once

#include <headway/core/detection.h>

#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway {

/// A box round a moving object [px], left rectified image.
struct MovingBox : Box2d {
  double to_m = std::numeric_limits<double>::infinity();  ///< depth beyond which nothing is of it
};

/// Regions of a left image on moving objects, excluded from the landmarks.
struct MovingRegions {
  std::vector<MovingBox> boxes;
  std::vector<MovingBox> unsure;  ///< of movable objects that may be static
  cv::Mat mask;                   ///< 8-bit, non-zero on moving objects; empty: boxes only
};

}  // namespace headway
