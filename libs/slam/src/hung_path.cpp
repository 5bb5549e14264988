#include "hung_path.h"

namespace headway::slam {

void HungPath::add(std::size_t frame, Time time, bool tracked, const Pose& T_map_cam,
                   const std::optional<KeyframeId>& reference, const SparseMap& map) {
  HungPose hung{frame, time, tracked, {}, T_map_cam};
  if (reference) {
    hung.reference = *reference;
    hung.T_reference_cam = map.keyframe(*reference).T_map_cam.inverse(Eigen::Isometry) * T_map_cam;
  }
  poses_.push_back(hung);
}

void HungPath::handOn(KeyframeId from, KeyframeId to, const SparseMap& map) {
  const Pose T_to_from =
      map.keyframe(to).T_map_cam.inverse(Eigen::Isometry) * map.keyframe(from).T_map_cam;
  for (HungPose& hung : poses_) {
    if (hung.reference != from) continue;
    hung.reference = to;
    hung.T_reference_cam = T_to_from * hung.T_reference_cam;
  }
}

std::vector<FrameEstimate> HungPath::estimates(const SparseMap& map,
                                               const Pose& T_cam_robot) const {
  std::vector<FrameEstimate> estimates;
  estimates.reserve(poses_.size());
  for (const HungPose& hung : poses_) {
    const Pose T_map_cam = hung.reference.valid()
                               ? map.keyframe(hung.reference).T_map_cam * hung.T_reference_cam
                               : hung.T_reference_cam;
    estimates.push_back({hung.frame, hung.time, hung.tracked, normalized(T_map_cam * T_cam_robot)});
  }
  return estimates;
}

}  // namespace headway::slam
