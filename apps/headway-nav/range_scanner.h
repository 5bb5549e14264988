#pragma once

#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/math/TPose2D.h>

#include "crowd.h"

namespace headway::app {

/// A scanner all round, one ray a degree: the points of now.
class RangeScanner {
 public:
  RangeScanner(const SensorParams& params, std::uint64_t seed);

  /// Points in the robot's frame, 0.4 m above the ground, that replace those in `out`.
  void scan(const Crowd& crowd, const mrpt::math::TPose2D& robot,
            mrpt::maps::CSimplePointsMap& out);

 private:
  SensorParams params_;
  Random random_;
};

}  // namespace headway::app
