#include "relocaliser.h"

namespace headway::slam {

std::optional<Pose> relocalise(const std::vector<DescribedPoint>& points,
                               const std::vector<LandmarkId>& among, const SparseMap& map,
                               const StereoCamera& camera, int min_inliers) {
  std::vector<Descriptor> seen;
  for (const DescribedPoint& point : points) seen.push_back(point.descriptor);
  std::vector<Descriptor> known;
  std::vector<const Landmark*> landmarks;
  for (const LandmarkId id : among) {
    const Landmark* landmark = map.find(id);
    if (landmark == nullptr || landmark->descriptor == Descriptor{}) continue;
    known.push_back(landmark->descriptor);
    landmarks.push_back(landmark);
  }
  std::vector<PoseConstraint> constraints;
  for (const auto& [at, landmark] : matchDescriptors(seen, known)) {
    PoseConstraint constraint;
    constraint.point_map = landmarks[static_cast<std::size_t>(landmark)]->position;
    constraint.measurement.uv = points[static_cast<std::size_t>(at)].uv;
    constraint.measurement.sigma_px = 2.0;
    constraints.push_back(constraint);
  }
  const auto guess = poseByConsensus(constraints, camera, min_inliers, 3.0);
  if (!guess) return std::nullopt;
  const auto refined = refinePose(*guess, constraints, camera, {2.0, 2, 6});
  if (!refined || refined->inliers < min_inliers) return std::nullopt;
  return refined->T_map_cam;
}

}  // namespace headway::slam
