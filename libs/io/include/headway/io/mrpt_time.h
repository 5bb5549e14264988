#pragma once

#include <headway/core/pose.h>
#include <mrpt/core/Clock.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/poses/CPose3DQuat.h>

namespace headway::io {

/// Poses and times at the MRPT boundary. Each pair is inverse to the other; times up to half a
/// tick of MRPT's clock (50 ns) or what a double keeps of them.
[[nodiscard]] mrpt::poses::CPose3D mrptPose(const Pose& pose);
[[nodiscard]] mrpt::poses::CPose3DQuat mrptPoseQuat(const Pose& pose);
[[nodiscard]] Pose poseFrom(const mrpt::poses::CPose3D& pose);
[[nodiscard]] Pose poseFrom(const mrpt::poses::CPose3DQuat& pose);

/// MRPT's time of a time since the Unix epoch; 0 s is a valid time, not INVALID_TIMESTAMP.
[[nodiscard]] mrpt::Clock::time_point mrptTime(Time time);
[[nodiscard]] Time timeFrom(mrpt::Clock::time_point time);

}  // namespace headway::io
