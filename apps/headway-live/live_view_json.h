// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <string>

#include "live_page.h"

namespace headway::live {

/// The robot's positions so far, for the map; thinned and bounded.
class DrivenPath {
 public:
  void add(const Pose& T_map_robot);
  [[nodiscard]] const std::deque<Eigen::Vector2d>& positions() const { return positions_; }

 private:
  std::deque<Eigen::Vector2d> positions_;  ///< map frame, oldest first [m]
};

/// One event of the page: the view as JSON in one line, without pictures.
///
/// @param grid_version  of the picture of the occupancy grid
[[nodiscard]] std::string jsonOf(const LiveView& view, const DrivenPath& path,
                                 std::size_t grid_version);

/// The frame's left image as JPEG; empty without images.
[[nodiscard]] std::string jpegOf(const RecordedFrame& frame);

/// The occupancy grid as PNG with transparent unknown cells, greatest y first; empty without one.
[[nodiscard]] std::string pngOf(const map::PerceptionMap& map);

}  // namespace headway::live
