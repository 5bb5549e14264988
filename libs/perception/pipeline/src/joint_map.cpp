// SPDX-License-Identifier: BSD-3-Clause
#include <headway/pipeline/joint_map.h>
#include <headway/slam/joint_map.h>

#include <algorithm>
#include <utility>

#include "perception_implementation.h"

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

bool startsBefore(const JointMap& a, const JointMap& b) { return a.runs.front() < b.runs.front(); }

}  // namespace

std::vector<JointMap> joinMaps(const std::vector<Perception*>& perceptions) {
  std::vector<Perception::Implementation*> runs;
  for (Perception* perception : perceptions) runs.push_back(perception->implementation_.get());
  std::vector<JointMap> maps;
  std::vector<const slam::StereoSlam*> by_slam;
  std::vector<std::size_t> run_of;  // of each of them
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const auto* slam = runs[run]->localisation.slam();
    if (slam == nullptr) {
      maps.push_back({{run}, {Pose::Identity()}, 0, perceptions[run]->stored()});
      continue;
    }
    by_slam.push_back(slam);
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
    const auto& first = *runs[map.runs.front()];
    if (is_alone) map.stored = perceptions[map.runs.front()]->stored();
    if (is_alone) continue;
    map::StaticGrid grid(first.mapping.gridParams());
    map::DenseMap dense = first.mapping.dense().emptyMap();
    for (const auto& member : inOrderOfTime(joint.members)) {
      grid.add(runs[run_of[member->run]]->mapping.grid(), member->keyframe_shift);
      dense.add(runs[run_of[member->run]]->mapping.dense().map(), member->keyframe_shift);
    }
    map.stored.camera = *first.camera;
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
