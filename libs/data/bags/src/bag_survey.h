// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_selection.h>

#include <map>
#include <string>

#include "transform_tree.h"

namespace headway::bags {

/// What the beginning of a bag tells about the sensors.
struct BagSurvey {
  std::map<std::string, io::CameraInfo> camera_infos;  ///< by topic
  std::map<std::string, std::string> frames;           ///< of the sensors' topics
  TransformTree transforms;
};

/// Reads until all is known, or for 10 s of the recording; for camera_info to the end.
[[nodiscard]] BagSurvey surveyBag(const std::string& path, const BagSelection& selection);

}  // namespace headway::bags
