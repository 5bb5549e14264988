// SPDX-License-Identifier: BSD-3-Clause
#include "anchored_trajectory.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

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
  if (log_) {
    log_({TrajectoryRecord::Kind::kFrame,
          frame,
          time,
          tracked,
          {},
          anchored.reference,
          anchored.T_reference_cam});
  }
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
  if (log_) log_({TrajectoryRecord::Kind::kMove, 0, 0.0, false, from, to, stored(T_to_from)});
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

Reassignments AnchoredTrajectory::reassignments() const {
  Reassignments moved;
  moved_.visit([&](const Reassignment& one) { moved.add(one); });
  return moved;
}

void AnchoredTrajectory::visit(const SparseMap& map, const Pose& T_cam_robot,
                               const std::function<void(const FrameEstimate&)>& callback) const {
  const Reassignments moved = reassignments();
  frames_.visit([&](AnchoredPose anchored) {
    moved.follow(anchored.reference, anchored.T_reference_cam);
    Pose T_map_cam = poseFrom(anchored.T_reference_cam);
    if (anchored.reference.valid()) {
      // Without its keyframe, whose reassignment found no place on the disk, it is left out.
      const auto keyframe = map.keyframes().find(anchored.reference);
      if (keyframe == map.keyframes().end()) return;
      T_map_cam = keyframe->second.T_map_cam * T_map_cam;
    }
    callback(
        {anchored.frame, anchored.time, anchored.tracked, normalized(T_map_cam * T_cam_robot)});
  });
}

std::optional<AnchoredTrajectory::Anchored> AnchoredTrajectory::find(std::size_t frame,
                                                                     const SparseMap& map) const {
  const auto& recent = frames_.recent();
  const auto found = std::lower_bound(
      recent.begin(), recent.end(), frame,
      [](const AnchoredPose& anchored, std::size_t index) { return anchored.frame < index; });
  if (found == recent.end() || found->frame != frame) return std::nullopt;
  Anchored result{found->time, poseFrom(found->T_reference_cam), found->reference, found->tracked};
  if (result.reference.valid()) {
    result.T_map_cam = map.keyframe(result.reference).T_map_cam * result.T_map_cam;
  }
  return result;
}

std::optional<std::size_t> AnchoredTrajectory::lastFrame() const {
  if (frames_.empty()) return std::nullopt;
  return frames_.back().frame;
}

void AnchoredTrajectory::restore(const TrajectoryReader& next, const SparseMap& map) {
  const auto require = [](bool is_valid) {
    if (!is_valid) throw InputError("damaged: the steps of the trajectory contradict each other");
  };
  std::unordered_set<KeyframeId> removed;
  while (const auto record = next()) {
    const auto& pose = record->pose.values;
    require(std::all_of(pose.begin(), pose.end(), [](double x) { return std::isfinite(x); }));
    require(removed.count(record->reference) == 0);
    if (record->kind == TrajectoryRecord::Kind::kMove) {
      require(record->reference.valid() && record->keyframe != record->reference);
      require(removed.insert(record->keyframe).second);
      moved_.append({record->keyframe, record->reference, record->pose});
      continue;
    }
    require(record->kind == TrajectoryRecord::Kind::kFrame);
    require(frames_.empty() || frames_.back().frame < record->frame);
    frames_.append({record->frame, record->time, record->reference, record->pose, record->tracked});
  }
  const Reassignments moved = reassignments();
  for (AnchoredPose& anchored : frames_.recent()) {
    moved.follow(anchored.reference, anchored.T_reference_cam);
    require(!anchored.reference.valid() || map.keyframes().count(anchored.reference) > 0);
  }
}

}  // namespace headway::slam
