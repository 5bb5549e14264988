#pragma once

#include <headway/core/pose.h>

#include <optional>
#include <string>
#include <vector>

namespace headway::io {

/// Robot poses of a side file, by time or by frame: TUM (`t x y z qx qy qz qw`, the robot's poses)
/// or KITTI (3x4, one a frame, of the left camera in the first one), told apart by their columns.
class PoseFile {
 public:
  /// @param T_robot_cam  the camera of KITTI poses
  /// @throws InputError naming file and line of what cannot be read
  PoseFile(const std::string& path, const Pose& T_robot_cam);

  /// T_map_robot of a frame; nullopt where the file has none. Between two times that are at most
  /// 0.5 s apart it is interpolated.
  [[nodiscard]] std::optional<Pose> at(std::size_t frame, Time time) const;

 private:
  std::vector<Stamped<Pose>> by_time_;
  std::vector<Pose> by_frame_;
};

}  // namespace headway::io
