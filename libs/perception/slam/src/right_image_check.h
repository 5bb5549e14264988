// SPDX-License-Identifier: BSD-3-Clause
// Whether the right image shows what the map says.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/slam/slam_params.h>

#include <optional>

#include "frame_tracker.h"
#include "landmark_tracker.h"
#include "sparse_map.h"

namespace headway::slam {

/// Compares the right image with the landmarks by which the left one was tracked.
///
/// A right image that is shifted gives most of them no disparity, or one that does not fit the
/// pose.
class RightImageCheck {
 public:
  /// Takes a frame.
  ///
  /// @param tracked  nullptr: it was not, or by a map that is too new to be relied on
  void add(const TrackedPose* tracked, const TrackingFrame& frame, const SparseMap& map,
           const StereoCamera& camera, const SlamParams& params);
  /// Whether the images contradict the map, and have not agreed with it for a second since.
  [[nodiscard]] bool isContradictory() const { return contradicted_.has_value(); }
  /// Whether the newest frame may become part of the map.
  [[nodiscard]] bool mayExtend() const { return !contradicted_ || agrees_; }

 private:
  bool agrees_ = true;                ///< the newest frame
  std::optional<Time> contradicted_;  ///< last, or nothing could be told since it was
};

}  // namespace headway::slam
