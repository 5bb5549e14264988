// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/sim/crowd.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/math/TPose2D.h>

#include <random>

#include "trial_params.h"

namespace headway::app {

/// A range scanner of 360 degrees, one ray per degree.
class RangeScanner {
 public:
  RangeScanner(const SensorParams& params, std::uint64_t seed);

  /// Points in the robot's frame, 0.4 m above the ground, that replace those in `out`.
  void scan(const sim::Crowd& crowd, const mrpt::math::TPose2D& robot,
            mrpt::maps::CSimplePointsMap& out);

 private:
  SensorParams params_;
  std::mt19937_64 random_;
};

}  // namespace headway::app
