// SPDX-License-Identifier: BSD-3-Clause
#include <headway/slam/trajectory_record.h>

#include <map>

#include "reassignments.h"

namespace headway::slam {

void visitTrajectory(const std::function<TrajectoryReader()>& records, const MapView& map,
                     const Pose& T_robot_cam,
                     const std::function<void(const FrameEstimate&)>& callback) {
  using Kind = TrajectoryRecord::Kind;
  Reassignments moved;
  auto next = records();
  while (const auto record = next()) {
    if (record->kind == Kind::kMove) moved.add({record->keyframe, record->reference, record->pose});
  }
  std::map<KeyframeId, Pose> cameras;  // of the keyframes, in the map
  for (const KeyframeView& keyframe : map.keyframes) {
    cameras[keyframe.id] = keyframe.T_map_robot * T_robot_cam;
  }
  const Pose T_cam_robot = T_robot_cam.inverse(Eigen::Isometry);
  next = records();
  while (auto record = next()) {
    if (record->kind == Kind::kMove) continue;
    Pose T_map_robot = poseFrom(record->pose);
    if (record->kind == Kind::kFrame) {
      moved.follow(record->reference, record->pose);
      Pose T_map_cam = poseFrom(record->pose);
      if (record->reference.valid()) {
        const auto keyframe = cameras.find(record->reference);
        if (keyframe == cameras.end()) continue;
        T_map_cam = keyframe->second * T_map_cam;
      }
      T_map_robot = normalized(T_map_cam * T_cam_robot);
    }
    callback({record->frame, record->time, record->tracked, T_map_robot});
  }
}

}  // namespace headway::slam
