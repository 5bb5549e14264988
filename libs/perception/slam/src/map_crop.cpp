// SPDX-License-Identifier: BSD-3-Clause
#include <headway/slam/map_crop.h>

#include <utility>
#include <vector>

#include "map_archive.h"

namespace headway::slam {

std::string croppedMap(const std::string& saved, const Eigen::AlignedBox3d& box,
                       const Pose& T_robot_cam) {
  StereoCamera camera;
  SparseMap map = unpackMap(saved, {}, &camera);
  const Pose T_cam_robot = T_robot_cam.inverse(Eigen::Isometry);
  std::vector<KeyframeId> outside;
  for (const auto& [id, keyframe] : map.keyframes()) {
    const Pose T_map_robot = keyframe.T_map_cam * T_cam_robot;
    if (!box.contains(T_map_robot.translation())) outside.push_back(id);
  }
  for (const KeyframeId id : outside) map.removeKeyframe(id);
  std::vector<LandmarkId> outer_landmarks;
  for (const auto& [id, landmark] : map.landmarks()) {
    if (!box.contains(landmark.position)) outer_landmarks.push_back(id);
  }
  for (const LandmarkId id : outer_landmarks) map.removeLandmark(id);
  return packMap(map, camera);
}

}  // namespace headway::slam
