// SPDX-License-Identifier: BSD-3-Clause
#include "relocaliser.h"

#include "consensus.h"

namespace headway::slam {

Recognition relocalise(const std::vector<DescribedPoint>& points,
                       const std::vector<LandmarkId>& among, const SparseMap& map,
                       const StereoCamera& camera, int min_inliers) {
  constexpr int kFewest = 6;    ///< that are called a consensus at all
  constexpr int kTries = 1000;  ///< seen from elsewhere, few descriptors are matched rightly
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
  std::vector<stereo::PoseConstraint> constraints;
  for (const auto& [at, landmark] : matchDescriptors(seen, known)) {
    stereo::PoseConstraint constraint;
    constraint.point_map = landmarks[static_cast<std::size_t>(landmark)]->position;
    constraint.measurement.uv = points[static_cast<std::size_t>(at)].uv;
    constraint.measurement.sigma_px = 2.0;
    constraints.push_back(constraint);
  }
  Recognition recognition;
  const auto initial = poseByConsensus(constraints, camera, kFewest, 3.0, kTries);
  if (!initial) return recognition;
  recognition.inliers = initial->inliers;
  if (initial->inliers < min_inliers) return recognition;
  const auto refined = stereo::refinePose(initial->T_map_cam, constraints, camera, {2.0, 2, 6});
  recognition.inliers = refined ? refined->inliers : 0;
  if (refined && refined->inliers >= min_inliers) recognition.T_map_cam = refined->T_map_cam;
  return recognition;
}

}  // namespace headway::slam
