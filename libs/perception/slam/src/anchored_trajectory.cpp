// SPDX-License-Identifier: BSD-3-Clause
// The poses of all frames, each stored relative to a keyframe, so that corrections of the map move
// them.
#include "anchored_trajectory.h"

#include <iterator>
#include <utility>

namespace headway::slam {

void Reassignments::follow(KeyframeId& reference, StoredPose& T_reference_cam) const {
  auto one = reference.valid() ? by_keyframe_.find(reference) : by_keyframe_.end();
  if (one == by_keyframe_.end()) return;
  Pose pose = poseFrom(T_reference_cam);
  for (; one != by_keyframe_.end(); one = by_keyframe_.find(reference)) {
    pose = poseFrom(one->second.T_to_from) * pose;
    reference = one->second.to;
  }
  T_reference_cam = stored(pose);
}

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

void AnchoredTrajectory::followAdjustment(KeyframeId from, const Pose& tracked,
                                          const Pose& adjusted, Time time) {
  constexpr double kRamp_s = 2.0;  ///< of a robot that stood, and moves again at the end of it
  auto& frames = frames_.recent();
  auto first = frames.end();
  while (first != frames.begin() && std::prev(first)->reference == from &&
         time - std::prev(first)->time <= kRamp_s) {
    --first;
  }
  if (first == frames.end() || !(time > first->time)) return;
  const Pose change = adjusted * tracked.inverse(Eigen::Isometry);
  const Eigen::Vector3d turn = logSo3(change.linear());
  for (auto at = first; at != frames.end(); ++at) {
    const double ratio = (at->time - first->time) / (time - first->time);
    Pose part(expSo3(ratio * turn));
    part.translation() = ratio * change.translation();
    at->T_reference_cam = stored(part * poseFrom(at->T_reference_cam));
  }
}

void AnchoredTrajectory::scale(const std::map<KeyframeId, double>& ratios) {
  for (AnchoredPose& anchored : frames_.recent()) {
    const auto ratio = ratios.find(anchored.reference);
    if (ratio == ratios.end()) continue;
    Pose T_reference_cam = poseFrom(anchored.T_reference_cam);
    T_reference_cam.translation() *= ratio->second;
    anchored.T_reference_cam = stored(T_reference_cam);
  }
}

TrajectoryVisit AnchoredTrajectory::snapshot(const SparseMap& map, const Pose& T_cam_robot) const {
  std::map<KeyframeId, Pose> cameras;
  for (const auto& [id, keyframe] : map.keyframes()) cameras[id] = keyframe.T_map_cam;
  return [=, frames = frames_.snapshot(), moves = moved_.snapshot(),
          cameras = std::move(cameras)](const FrameVisitor& visit) {
    Reassignments moved;
    moves->visit([&](const Reassignment& one) { moved.add(one); });
    frames->visit([&](AnchoredPose anchored) {
      moved.follow(anchored.reference, anchored.T_reference_cam);
      Pose T_map_cam = poseFrom(anchored.T_reference_cam);
      if (anchored.reference.valid()) {
        // Without its keyframe, whose reassignment found no place on the disk, it is left out.
        const auto camera = cameras.find(anchored.reference);
        if (camera == cameras.end()) return;
        T_map_cam = camera->second * T_map_cam;
      }
      visit({anchored.frame, anchored.time, anchored.tracked, normalized(T_map_cam * T_cam_robot)});
    });
  };
}

}  // namespace headway::slam
