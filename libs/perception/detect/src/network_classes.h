// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>

#include <optional>
#include <string>
#include <vector>

namespace headway::detect {

/// What one class of a network means to us.
struct NetworkClass {
  std::optional<ObjectClass> object_class;  ///< nullopt: nothing of ours
  bool bicycle = false;                     ///< without its rider
};

/// The classes of a network in its order.
///
/// @param names  "coco" for the 80 of the COCO data set, or names in KITTI's spelling separated by
///               commas; any other word among them stands for a class that is left out
[[nodiscard]] std::vector<NetworkClass> networkClasses(const std::string& names);

/// One box as a network gave it.
struct NetworkBox {
  Box2d box;  ///< [px] of the image
  double score = 0.0;
  std::size_t network_class = 0;
};

/// Makes detections of a network's boxes: classes translated, riders joined with their bicycles,
/// and of two classes of one vehicle the one of greater score.
///
/// @param boxes  best first
[[nodiscard]] std::vector<Detection> toDetections(const std::vector<NetworkBox>& boxes,
                                                  const std::vector<NetworkClass>& classes);

}  // namespace headway::detect
