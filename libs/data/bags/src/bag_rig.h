// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_import.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bag_survey.h"

namespace headway::bags {

/// Calibration and mounting of the sensors of a bag.
struct BagRig {
  io::RawStereoCamera stereo;  ///< if a stereo camera is selected
  io::RawCamera color;         ///< if a depth camera is, as the following
  io::RawCamera depth;
  Pose T_robot_color = Pose::Identity();       ///< optical frame
  Pose T_robot_depth = Pose::Identity();       ///< optical frame
  std::map<std::string, Pose> T_robot_sensor;  ///< by topic; missing: unknown
  std::map<std::string, std::string> frames;   ///< of sensors by topic, for messages
  std::string base_frame;                      ///< empty: no transforms
  TransformTree transforms;
  std::vector<std::string> notes;  ///< what had to be assumed
};

/// @throws InputError naming the topic whose calibration is missing or impossible
[[nodiscard]] BagRig rigOf(const BagSurvey& survey, const BagImportOptions& options);

}  // namespace headway::bags
