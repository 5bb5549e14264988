// SPDX-License-Identifier: BSD-3-Clause
#include "make_map_view.h"

#include <headway/slam/stereo_slam.h>

#include "map_archive.h"
#include "pose_covariance.h"

namespace headway::slam {
namespace {

/// Grey value of a landmark where it was seen when its patch was cut.
std::uint8_t intensityOf(const stereo::ReferencePatch& patch) {
  const auto centre = patch.centre.array().round().cast<int>();
  return patch.pixels[centre.y() * stereo::ReferencePatch::kSize + centre.x()];
}

bool isIn(int submap, const Landmark& landmark, const SparseMap& map) {
  return map.submapOf(landmark.reference) == submap;
}

bool isIn(int submap, const Keyframe& keyframe, const SparseMap&) {
  return keyframe.submap == submap;
}

LandmarkView viewOf(const Landmark& landmark, const Pose& /*T_cam_robot*/) {
  return {landmark.id, landmark.position, static_cast<int>(landmark.observations.size()),
          intensityOf(*landmark.patch)};
}

KeyframeView viewOf(const Keyframe& keyframe, const Pose& T_cam_robot) {
  return {keyframe.id,
          keyframe.frame,
          keyframe.time,
          normalized(keyframe.T_map_cam * T_cam_robot),
          composedCovariance(keyframe.covariance, T_cam_robot, PoseCovariance::Zero()),
          keyframe.landmarks};
}

/// The groups that elements are in, ascending.
template <typename Id, typename Element>
std::vector<std::int64_t> groupsOf(const std::map<Id, Element>& elements) {
  IdGroups groups;
  for (const auto& [id, element] : elements) groups.add(id.value);
  return groups.take();
}

/// Makes the chunks of changed groups anew, and puts all chunks together.
template <typename Id, typename Element, typename View>
SharedChunks<View> updated(
    const std::map<Id, Element>& elements, const std::vector<std::int64_t>& changed,
    const Pose& T_cam_robot, int submap, const SparseMap& map,
    std::map<std::int64_t, std::shared_ptr<const std::vector<View>>>& groups) {
  for (const std::int64_t group : changed) {
    auto chunk = std::make_shared<std::vector<View>>();
    auto at = elements.lower_bound(Id{group * IdGroups::kSize});
    for (; at != elements.end() && at->first.value / IdGroups::kSize == group; ++at) {
      if (isIn(submap, at->second, map)) chunk->push_back(viewOf(at->second, T_cam_robot));
    }
    if (chunk->empty()) {
      groups.erase(group);
    } else {
      groups[group] = std::move(chunk);
    }
  }
  SharedChunks<View> all;
  for (const auto& [group, chunk] : groups) all.append(chunk);
  return all;
}

}  // namespace

MapView MapViewMaker::make(SparseMap& map, int submap) {
  auto landmarks = map.takeChangedLandmarks();
  auto keyframes = map.takeChangedKeyframes();
  if (submap != submap_) {
    reset();
    landmarks = groupsOf(map.landmarks());
    keyframes = groupsOf(map.keyframes());
    submap_ = submap;
  }
  return {updated(map.landmarks(), landmarks, T_cam_robot_, submap, map, landmarks_),
          updated(map.keyframes(), keyframes, T_cam_robot_, submap, map, keyframes_)};
}

MapView makeMapView(const SparseMap& map, const Pose& T_cam_robot, int submap) {
  std::map<std::int64_t, std::shared_ptr<const std::vector<LandmarkView>>> landmarks;
  std::map<std::int64_t, std::shared_ptr<const std::vector<KeyframeView>>> keyframes;
  return {updated(map.landmarks(), groupsOf(map.landmarks()), T_cam_robot, submap, map, landmarks),
          updated(map.keyframes(), groupsOf(map.keyframes()), T_cam_robot, submap, map, keyframes)};
}

MapView savedMapView(const std::string& saved, const Pose& T_robot_cam) {
  return makeMapView(unpackMap(saved, {}), T_robot_cam.inverse(), 0);
}

}  // namespace headway::slam
