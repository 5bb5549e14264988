// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/ids.h>
#include <headway/core/record_log.h>
#include <headway/slam/map_view.h>

#include <cstddef>
#include <functional>
#include <optional>

namespace headway::slam {

/// One step of a trajectory that is anchored to keyframes. All records of a run, in order, restore
/// its trajectory in the run's map, also if that was corrected after they were made.
struct TrajectoryRecord {
  enum class Kind {
    kFrame,  ///< a frame: pose of its camera in `reference`, or in the map if that is invalid
    kMove,   ///< `keyframe` was removed, and its frames belong to `reference`: its pose in that
    kGiven,  ///< a frame whose pose was recorded: pose of the robot in the map
  };
  Kind kind = Kind::kFrame;
  std::size_t frame = 0;  ///< index
  Time time = 0.0;        ///< of the frame [s]
  bool tracked = false;   ///< kGiven: the pose is the frame's own, not the last one given
  KeyframeId keyframe;
  KeyframeId reference;
  StoredPose pose{};
};

using TrajectoryLog = std::function<void(const TrajectoryRecord&)>;

/// Gives the records of a run one by one; nullopt after the last one.
using TrajectoryReader = std::function<std::optional<TrajectoryRecord>()>;

/// Calls back with the poses of all frames of a run, in order, at the moment of a map. Memory grows
/// with the keyframes only.
///
/// @param records      gives the run's records up to that moment; each call begins with the first
/// @param T_robot_cam  pose of the left camera on the robot
void visitTrajectory(const std::function<TrajectoryReader()>& records, const MapView& map,
                     const Pose& T_robot_cam,
                     const std::function<void(const FrameEstimate&)>& callback);

}  // namespace headway::slam
