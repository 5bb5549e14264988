// SPDX-License-Identifier: BSD-3-Clause
#include <headway/pipeline/joint_map.h>
#include <headway/slam/joint_map.h>

#include <algorithm>
#include <utility>

namespace headway::pipeline {

namespace {

/// Ids of keyframes follow the runs' times, so that the latest scan of a place is the one that
/// remains.
std::vector<const slam::JointMember*> inOrderOfTime(const std::vector<slam::JointMember>& members) {
  std::vector<const slam::JointMember*> ordered;
  for (const auto& member : members) ordered.push_back(&member);
  std::sort(ordered.begin(), ordered.end(),
            [](const auto* a, const auto* b) { return a->keyframe_shift < b->keyframe_shift; });
  return ordered;
}

bool startsBefore(const JointMap& a, const JointMap& b) {
  return a.runs.front() < b.runs.front();
}

}  // namespace

/// The run's static layers become those of its part of a joint map. @return T_map_run
Pose Perception::moveInto(const slam::KeyframePoses& poses) {
  if (poses.empty()) return Pose::Identity();
  const Pose before = slam_->map().keyframes.front().T_map_robot;
  slam_->correct(poses);
  map_.update(slam_->map());
  grid_.follow(map_.staticMap()->keyframes);
  if (const auto grid = grid_.grid()) map_.update(grid);
  dense_.follow(map_.staticMap()->keyframes);
  updateDenseMap();
  map_.update(last_time_.value_or(0.0), std::vector<Track>());
  const Pose now = map_.staticMap()->keyframes.front().T_map_robot;
  return normalized(Pose(now * before.inverse(Eigen::Isometry)));
}

std::vector<JointMap> joinMaps(const std::vector<Perception*>& runs) {
  std::vector<JointMap> maps;
  std::vector<const slam::StereoSlam*> by_slam;
  std::vector<std::size_t> run_of;  // of each of them
  for (std::size_t run = 0; run < runs.size(); ++run) {
    if (!runs[run]->given_poses_.empty() || runs[run]->slam_ == nullptr) {
      maps.push_back({{run}, {Pose::Identity()}, 0, runs[run]->stored()});
      continue;
    }
    by_slam.push_back(runs[run]->slam_.get());
    run_of.push_back(run);
  }
  for (auto& joint : by_slam.empty() ? std::vector<slam::JointMap>() : slam::joinMaps(by_slam)) {
    JointMap& map = maps.emplace_back(JointMap{{}, {}, joint.links, {}});
    const bool is_alone = joint.members.size() == 1;
    for (const auto& member : joint.members) {
      const std::size_t run = run_of[member.run];
      map.runs.push_back(run);
      map.T_map_run.push_back(is_alone ? Pose::Identity() : runs[run]->moveInto(member.poses));
    }
    const Perception& first = *runs[map.runs.front()];
    if (is_alone) map.stored = first.stored();
    if (is_alone) continue;
    map::StaticGrid grid(first.grid_params_.map);
    map::DenseMap dense = first.dense_.emptyMap();
    for (const auto& member : inOrderOfTime(joint.members)) {
      grid.add(runs[run_of[member->run]]->grid_, member->keyframe_shift);
      dense.add(runs[run_of[member->run]]->dense_.map(), member->keyframe_shift);
    }
    map.stored.camera = *first.camera_;
    map.stored.map.update(std::move(joint.view));
    if (const auto cells = grid.grid()) map.stored.map.update(cells);
    if (const auto points = dense.layer()) map.stored.map.update(points);
    map.stored.attachments[map::kGridAttachment] = grid.save();
    map.stored.made_attachments[map::kDenseAttachment] = dense.save();
    map.stored.made_attachments[map::kSlamAttachment] = std::move(joint.saved);
  }
  std::sort(maps.begin(), maps.end(), startsBefore);
  return maps;
}

}  // namespace headway::pipeline
