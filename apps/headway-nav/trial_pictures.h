// SPDX-License-Identifier: BSD-3-Clause
// Pictures of trials from above, the policies side by side.
#pragma once

#include <headway/map/perception_map.h>
#include <mrpt/math/TPose2D.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "trial.h"

namespace headway::app {

/// Record of one trial, for pictures.
struct TrialRecord {
  std::string policy;
  std::vector<TrialMoment> moments;
  TrialResult result;
};

/// The ground about a robot that looks up, by what its newest frames show and by the map's grid.
[[nodiscard]] cv::Mat drawGround(const map::PerceptionMap& map, double caution,
                                 const mrpt::math::TPose2D& pose, const RobotParams& robot);

/// The moment at one time of each record, side by side; a record that has ended shows its last one.
/// The robot drives upwards.
[[nodiscard]] cv::Mat drawMoment(const std::vector<TrialRecord>& records, const RobotParams& robot,
                                 double time_s);

/// Each record as a whole: robot and people at every second.
[[nodiscard]] cv::Mat drawWhole(const std::vector<TrialRecord>& records, const RobotParams& robot);

}  // namespace headway::app
