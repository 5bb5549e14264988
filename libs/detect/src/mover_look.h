#pragma once

#include <headway/core/pose.h>

#include "appearance.h"
#include "object_extent.h"

namespace headway::detect {

/// A mover as stereo showed it last, to know it again by.
struct MoverLook {
  Appearance appearance;
  ObjectExtent extent;  ///< camera frame then
  Pose T_world_cam = Pose::Identity();
  Time time = 0.0;
  int points = 0;  ///< that told of it
};

}  // namespace headway::detect
