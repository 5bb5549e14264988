#pragma once

#include <headway/core/ids.h>
#include <headway/core/record_log.h>

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

}  // namespace headway::slam
