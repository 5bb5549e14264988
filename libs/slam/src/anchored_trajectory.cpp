#include "anchored_trajectory.h"

namespace headway::slam {

void AnchoredTrajectory::add(std::size_t frame, Time time, bool tracked, const Pose& T_map_cam,
                             const std::optional<KeyframeId>& reference, const SparseMap& map) {
  AnchoredPose anchored{frame, time, tracked, {}, T_map_cam};
  if (reference) {
    anchored.reference = *reference;
    anchored.T_reference_cam =
        map.keyframe(*reference).T_map_cam.inverse(Eigen::Isometry) * T_map_cam;
  }
  poses_.push_back(anchored);
}

void AnchoredTrajectory::reassign(KeyframeId from, KeyframeId to, const SparseMap& map) {
  const Pose T_to_from =
      map.keyframe(to).T_map_cam.inverse(Eigen::Isometry) * map.keyframe(from).T_map_cam;
  for (AnchoredPose& anchored : poses_) {
    if (anchored.reference != from) continue;
    anchored.reference = to;
    anchored.T_reference_cam = T_to_from * anchored.T_reference_cam;
  }
}

std::vector<FrameEstimate> AnchoredTrajectory::estimates(const SparseMap& map,
                                                         const Pose& T_cam_robot) const {
  std::vector<FrameEstimate> estimates;
  estimates.reserve(poses_.size());
  for (const AnchoredPose& anchored : poses_) {
    const Pose T_map_cam = anchored.reference.valid() ? map.keyframe(anchored.reference).T_map_cam *
                                                            anchored.T_reference_cam
                                                      : anchored.T_reference_cam;
    estimates.push_back(
        {anchored.frame, anchored.time, anchored.tracked, normalized(T_map_cam * T_cam_robot)});
  }
  return estimates;
}

}  // namespace headway::slam
