// SPDX-License-Identifier: BSD-3-Clause
#include "loop_correction.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "keyframe_odometry.h"

namespace headway::slam {
namespace {

PoseGraphEdge edgeBetween(const Keyframe& a, const Keyframe& b) {
  constexpr double kSigmaFloorM = 0.005;
  constexpr double kSigmaPerM = 0.01;
  constexpr double kSigmaFloorRad = 0.0005;
  constexpr double kSigmaRadPerM = 0.0005;
  PoseGraphEdge edge;
  edge.a = a.id;
  edge.b = b.id;
  edge.T_a_b = a.T_map_cam.inverse(Eigen::Isometry) * b.T_map_cam;
  const double length = edge.T_a_b.translation().norm();
  edge.sigma_m = kSigmaFloorM + kSigmaPerM * length;
  edge.sigma_rad = kSigmaFloorRad + kSigmaRadPerM * length;
  return edge;
}

/// Constrains a submap that shares no landmarks with the rest: by wheel odometry if that is known
/// throughout, or so weakly that any other edge outweighs it.
PoseGraphEdge edgeAcrossGap(const Keyframe& a, const Keyframe& b) {
  PoseGraphEdge edge = edgeBetween(a, b);
  edge.sigma_m = 100.0;
  edge.sigma_rad = 10.0;
  if (!b.odometry || b.odometry->from != a.id) return edge;
  const PoseCovariance covariance = covarianceOf(*b.odometry);
  edge.sigma_m = std::sqrt(covariance.diagonal().head<3>().maxCoeff());
  edge.sigma_rad = std::sqrt(covariance.diagonal().tail<3>().maxCoeff());
  return edge;
}

/// The keyframes that observe each landmark.
class Observers {
 public:
  explicit Observers(const std::map<KeyframeId, Keyframe>& keyframes) {
    for (const auto& [id, keyframe] : keyframes) {
      for (const LandmarkId landmark : keyframe.landmarks) observers_[landmark].push_back(id);
    }
  }

  /// As SparseMap::neighbourhood().
  [[nodiscard]] std::vector<KeyframeId> neighbourhood(const Keyframe& of, int count) const {
    std::map<KeyframeId, int> shared;
    for (const LandmarkId id : of.landmarks) {
      for (const KeyframeId keyframe : observers_.at(id)) ++shared[keyframe];
    }
    return mostShared(of.id, std::move(shared), count);
  }

 private:
  std::unordered_map<LandmarkId, std::vector<KeyframeId>> observers_;
};

}  // namespace

bool shareNoLandmarks(const Keyframe& a, const Keyframe& b) {
  auto at_a = a.landmarks.begin();
  auto at_b = b.landmarks.begin();
  while (at_a != a.landmarks.end() && at_b != b.landmarks.end()) {
    if (*at_a == *at_b) return false;
    *at_a < *at_b ? ++at_a : ++at_b;
  }
  return true;
}

std::vector<PoseGraphEdge> edgesOf(const std::map<KeyframeId, Keyframe>& keyframes) {
  constexpr int kNeighbours = 5;
  const Observers observers(keyframes);
  std::vector<PoseGraphEdge> edges;
  const Keyframe* before = nullptr;
  for (const auto& [id, keyframe] : keyframes) {
    if (before != nullptr) {
      edges.push_back(shareNoLandmarks(*before, keyframe) ? edgeAcrossGap(*before, keyframe)
                                                          : edgeBetween(*before, keyframe));
    }
    for (const KeyframeId other : observers.neighbourhood(keyframe, kNeighbours)) {
      if (other < id && (before == nullptr || other != before->id)) {
        edges.push_back(edgeBetween(keyframes.at(other), keyframe));
      }
    }
    before = &keyframe;
  }
  return edges;
}

std::map<KeyframeId, Keyframe> keyframesOfLoop(KeyframeId newest, KeyframeId old,
                                               const SparseMap& map) {
  std::map<KeyframeId, Keyframe> members;
  for (const auto& [id, keyframe] : map.keyframes()) {
    if (keyframe.submap != map.submapOf(newest) && keyframe.submap != map.submapOf(old)) continue;
    members.emplace_hint(members.end(), id, keyframe);
  }
  return members;
}

std::map<KeyframeId, Pose> posesWithLoop(const std::map<KeyframeId, Keyframe>& keyframes,
                                         const ClosedLoop& loop, const StopCondition& stop) {
  return posesWithLoops(keyframes, {loop}, stop);
}

std::map<KeyframeId, Pose> posesWithLoops(const std::map<KeyframeId, Keyframe>& keyframes,
                                          const std::vector<ClosedLoop>& loops,
                                          const StopCondition& stop) {
  auto edges = edgesOf(keyframes);
  for (const ClosedLoop& loop : loops) {
    PoseGraphEdge closing = edgeBetween(keyframes.at(loop.old), keyframes.at(loop.newest));
    closing.T_a_b = loop.T_old_newest;
    edges.push_back(closing);
  }
  std::map<KeyframeId, Pose> poses;
  for (const auto& [id, keyframe] : keyframes) poses[id] = keyframe.T_map_cam;
  return optimisePoseGraph(poses, edges, stop);
}

void applyCorrection(const std::map<KeyframeId, Pose>& corrected, SparseMap& map) {
  for (const auto& [id, landmark] : map.landmarks()) {
    const auto moved = corrected.find(landmark.reference);
    if (moved == corrected.end()) continue;
    const Pose T_cam_map = map.keyframe(landmark.reference).T_map_cam.inverse(Eigen::Isometry);
    map.findToChange(id)->position = moved->second * (T_cam_map * landmark.position);
  }
  for (const auto& [id, pose] : corrected) map.keyframeToChange(id).T_map_cam = pose;
}

void observeLoop(const ClosedLoop& loop, SparseMap& map) {
  const std::vector<LandmarkId> seen = map.keyframe(loop.newest).landmarks;
  for (const TrackedLandmark& landmark : loop.landmarks) {
    if (map.find(landmark.id) == nullptr) continue;
    if (std::binary_search(seen.begin(), seen.end(), landmark.id)) continue;
    map.observe(loop.newest, landmark.id, landmark.measurement);
  }
}

}  // namespace headway::slam
