// SPDX-License-Identifier: BSD-3-Clause
// Poses of scans that follow the nearest keyframe when the map is corrected.
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/ids.h>
#include <headway/core/pose.h>
#include <headway/core/shared_chunks.h>
#include <headway/slam/map_view.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>

namespace headway::map {

/// Place and direction of a scan in steps: x, y and heading.
using ScanPlace = std::array<std::int32_t, 3>;

/// @param spacing_m  between places, > 0 [m]; directions are 15 degrees apart
[[nodiscard]] ScanPlace scanPlace(const Pose& T_map_robot, double spacing_m);

/// A pose of the robot that follows the keyframe nearest to it.
struct AnchoredPose {
  Pose T_map_robot = Pose::Identity();
  KeyframeId anchor;  ///< invalid if there are no keyframes
  Pose T_anchor_robot = Pose::Identity();
};

void write(ByteWriter& out, const AnchoredPose& pose);

/// @throws InputError if the bytes end early or contain no rigid motions within a map
[[nodiscard]] AnchoredPose readAnchoredPose(ByteReader& in);

/// The latest poses of all keyframes, which anchored poses follow.
class AnchorPoses {
 public:
  void update(const SharedChunks<slam::KeyframeView>& keyframes);

  /// Anchors a pose at the nearest keyframe.
  void attach(AnchoredPose& pose) const;

  /// The pose by the anchor's present one; nullopt if it has moved by less than both limits. A pose
  /// whose anchor was removed is anchored anew, and stays.
  [[nodiscard]] std::optional<Pose> movedPose(AnchoredPose& pose, double min_m,
                                              double min_rad) const;

 private:
  std::map<KeyframeId, Pose> poses_;
};

}  // namespace headway::map
