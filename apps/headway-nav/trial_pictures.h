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

/// map::LocalState of the cells about a robot that looks up: at the left by what its newest frames
/// show, at the right by the map's grid.
[[nodiscard]] cv::Mat1b groundAbout(const mrpt::math::TPose2D& pose, const map::PerceptionMap& map,
                                    double caution);

/// A picture of groundAbout(); empty if that is.
[[nodiscard]] cv::Mat drawGround(const cv::Mat1b& ground, const RobotParams& robot);

/// The moment at one time of each record, side by side; a record that has ended shows its last one.
/// The robot drives upwards.
[[nodiscard]] cv::Mat drawMoment(const std::vector<TrialRecord>& records, const RobotParams& robot,
                                 double time_s);

/// Each record as a whole: robot and people at every second.
[[nodiscard]] cv::Mat drawWhole(const std::vector<TrialRecord>& records, const RobotParams& robot);

}  // namespace headway::app
