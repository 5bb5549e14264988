// SPDX-License-Identifier: BSD-3-Clause
// What a driven robot knows of its world: by its images, or by the truth.
#pragma once

#include <headway/map/perception_map.h>
#include <headway/objects/objects_params.h>
#include <headway/sim/driven_world.h>
#include <mrpt/math/TPose2D.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "navigator.h"

namespace headway::app {

/// Where a robot's knowledge comes from.
enum class Sense {
  kImages,      ///< perception of rendered images, nothing else
  kTruth,       ///< true pose, tracks and grid
  kDetections,  ///< a simulated detector and scanner in an abstract scene
};

/// "images", "truth", "detections".
[[nodiscard]] const std::vector<std::pair<std::string, Sense>>& senses();

/// What a robot knows at one time.
struct Knowledge {
  map::PerceptionMap map;                   ///< with the moving objects of that time
  std::optional<mrpt::math::TPose2D> pose;  ///< in the map; nullopt: lost
  mrpt::math::TPose2D expected;             ///< in the map, by odometry if it is lost
  cv::Mat image;                            ///< of the left camera; empty: none was taken
};

/// Perceives a driven world, once per frame interval.
class Eye {
 public:
  virtual ~Eye() = default;
  [[nodiscard]] virtual Knowledge perceive(sim::DrivenWorld& world) = 0;
};

/// The eye of a sense, kImages or kTruth.
///
/// @param local_layer  of images: with what each frame shows to be blocked, see map::LocalLayer
[[nodiscard]] std::unique_ptr<Eye> makeEye(Sense sense, const RobotParams& robot,
                                           const objects::ObjectsParams& objects, bool local_layer);

}  // namespace headway::app
