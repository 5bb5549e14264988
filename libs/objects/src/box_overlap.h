#pragma once

#include <headway/core/detection.h>

#include "measured_box.h"

namespace headway::objects {

/// Area of intersection over area of union of two image boxes; 0 if either has no area.
[[nodiscard]] double overlap2d(const Box2d& a, const Box2d& b);

/// Volume of intersection over volume of union of two upright boxes in the map.
[[nodiscard]] double overlap3d(const MeasuredBox& a, const MeasuredBox& b);

}  // namespace headway::objects
