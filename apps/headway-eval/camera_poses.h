#pragma once

#include <headway/core/pose.h>

#include <string>
#include <vector>

namespace headway::app {

/// Time between two frames where a file has no times: KITTI's [s].
inline constexpr double kNominalFrameInterval_s = 0.1;

/// Where the camera stands in the map at each frame, from a file with one row for each.
///
/// KITTI poses (camera in the first camera) have no times: frames are 0.1 s apart. TUM poses are
/// those of the robot in the map.
///
/// @throws InputError naming the file if it cannot be read
[[nodiscard]] std::vector<Stamped<Pose>> readCameraPoses(const std::string& path,
                                                         const Pose& T_robot_cam);

}  // namespace headway::app
