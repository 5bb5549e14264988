// SPDX-License-Identifier: BSD-3-Clause
// What a lost camera does: it looks for its place in the whole map.
#pragma once

#include <functional>
#include <optional>

#include "landmark_tracker.h"
#include "loop_closer.h"
#include "place_check.h"
#include "sparse_map.h"

namespace headway::slam {

/// Finds a lost camera in the whole map; state is kept from its first lost frame to the last.
class Relocaliser {
 public:
  using Allows = std::function<bool(const LocatedCamera&)>;

  /// @param loops  must outlive the relocaliser
  explicit Relocaliser(LoopCloser& loops) : loops_(loops) {}

  /// Where the camera is, by somebody who knows.
  void expect(const Pose& T_map_cam);

  /// Odometry moves on where the camera was said to be; to be called before each frame is tracked.
  ///
  /// @param T_odom_cam  of the frame before
  void moveExpected(const Pose& T_odom_cam);

  /// The place of a frame that is lost, once it is proven.
  ///
  /// @param turn        frames that are lost before this one
  /// @param T_odom_cam  as PlaceCheck::add()
  /// @param isLed       whether odometry leads to a place, which then needs no proof
  /// @param isAllowed   whether odometry allows a place at all
  [[nodiscard]] std::optional<LocatedCamera> locate(const TrackingFrame& frame, int turn,
                                                    const Pose& T_odom_cam,
                                                    const std::function<bool(const Pose&)>& isLed,
                                                    const Allows& isAllowed, const SparseMap& map);

  /// The camera need not be searched for any longer.
  ///
  /// @param is_in_map  not in a submap of its own: its place in the map is still asked for then
  void end(bool is_in_map);

 private:
  LoopCloser& loops_;
  PlaceCheck check_;
  std::optional<Pose> expected_;  ///< of the camera when that was said, until it is found there
  std::optional<Pose> T_odom_expected_;  ///< the camera in that frame
};

}  // namespace headway::slam
