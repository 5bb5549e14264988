#include "anchored_trajectory.h"

#include <unordered_map>

namespace headway::slam {

void AnchoredTrajectory::add(std::size_t frame, Time time, bool tracked, const Pose& T_map_cam,
                             const std::optional<KeyframeId>& reference, const SparseMap& map) {
  AnchoredPose anchored{frame, time, {}, stored(T_map_cam), tracked};
  if (reference) {
    anchored.reference = *reference;
    anchored.T_reference_cam =
        stored(map.keyframe(*reference).T_map_cam.inverse(Eigen::Isometry) * T_map_cam);
  }
  frames_.append(anchored);
}

void AnchoredTrajectory::reassign(KeyframeId from, KeyframeId to, const SparseMap& map) {
  const Pose T_to_from =
      map.keyframe(to).T_map_cam.inverse(Eigen::Isometry) * map.keyframe(from).T_map_cam;
  for (AnchoredPose& anchored : frames_.recent()) {
    if (anchored.reference != from) continue;
    anchored.reference = to;
    anchored.T_reference_cam = stored(T_to_from * poseFrom(anchored.T_reference_cam));
  }
  if (frames_.filed() > 0) moved_.append({from, to, stored(T_to_from)});
}

void AnchoredTrajectory::visit(const SparseMap& map, const Pose& T_cam_robot,
                               const std::function<void(const FrameEstimate&)>& callback) const {
  std::unordered_map<KeyframeId, Reassignment> moved;  // ids of keyframes are not used again
  moved_.visit([&](const Reassignment& one) { moved[one.from] = one; });
  frames_.visit([&](const AnchoredPose& anchored) {
    Pose T_map_cam = poseFrom(anchored.T_reference_cam);
    if (KeyframeId reference = anchored.reference; reference.valid()) {
      for (auto one = moved.find(reference); one != moved.end(); one = moved.find(reference)) {
        T_map_cam = poseFrom(one->second.T_to_from) * T_map_cam;
        reference = one->second.to;
      }
      const auto keyframe = map.keyframes().find(reference);
      if (keyframe == map.keyframes().end()) return;  // its reassignment found no place on the disk
      T_map_cam = keyframe->second.T_map_cam * T_map_cam;
    }
    callback(
        {anchored.frame, anchored.time, anchored.tracked, normalized(T_map_cam * T_cam_robot)});
  });
}

}  // namespace headway::slam
