// SPDX-License-Identifier: BSD-3-Clause
// The sparse map: keyframes, landmarks and their observations.
#include "sparse_map.h"

#include <headway/core/error.h>
#include <headway/stereo/rectification.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

namespace headway::slam {
namespace {

template <typename Id>
void insertSorted(std::vector<Id>& ids, Id id) {
  ids.insert(std::lower_bound(ids.begin(), ids.end(), id), id);
}

template <typename Id>
void eraseSorted(std::vector<Id>& ids, Id id) {
  const auto at = std::lower_bound(ids.begin(), ids.end(), id);
  if (at != ids.end() && *at == id) ids.erase(at);
}

}  // namespace

std::shared_ptr<const stereo::ReferencePatch> blankPatch() {
  static const auto blank = std::make_shared<const stereo::ReferencePatch>();
  return blank;
}

OdometryLink composed(const OdometryLink& first, const OdometryLink& second) {
  return {first.from, normalized(Pose(first.T_from_this * second.T_from_this)),
          first.path_m + second.path_m, first.turn_rad + second.turn_rad};
}

std::vector<std::int64_t> IdGroups::take() {
  std::vector<std::int64_t> groups(groups_.begin(), groups_.end());
  groups_.clear();
  last_ = -1;
  return groups;
}

SparseMap::SparseMap(const std::vector<Keyframe>& keyframes,
                     const std::vector<Landmark>& landmarks) {
  for (const Keyframe& keyframe : keyframes) {
    if (!keyframe.id.valid() || !keyframes_.emplace(keyframe.id, keyframe).second) {
      throw InputError("damaged: a keyframe's id is not valid or comes twice");
    }
    keyframes_.at(keyframe.id).landmarks.clear();
    changed_keyframes_.add(keyframe.id.value);
    next_keyframe_ = std::max(next_keyframe_, keyframe.id.value + 1);
  }
  for (const Landmark& landmark : landmarks) {
    if (!landmark.id.valid() || !landmarks_.emplace(landmark.id, landmark).second) {
      throw InputError("damaged: a landmark's id is not valid or comes twice");
    }
    changed_landmarks_.add(landmark.id.value);
    next_landmark_ = std::max(next_landmark_, landmark.id.value + 1);
    link(landmark);
  }
}

void SparseMap::link(const Landmark& landmark) {
  bool refers = false;
  for (const LandmarkObservation& observation : landmark.observations) {
    const auto keyframe = keyframes_.find(observation.keyframe);
    const auto& ids =
        keyframe == keyframes_.end() ? std::vector<LandmarkId>{} : keyframe->second.landmarks;
    if (keyframe == keyframes_.end() || std::binary_search(ids.begin(), ids.end(), landmark.id)) {
      throw InputError("damaged: a landmark's keyframe is not in the map or comes twice");
    }
    insertSorted(keyframe->second.landmarks, landmark.id);
    refers = refers || observation.keyframe == landmark.reference;
  }
  if (!refers) throw InputError("damaged: a landmark is not seen by its own keyframe");
}

Keyframe& SparseMap::addKeyframe(std::size_t frame, Time time, const Pose& T_map_cam) {
  const KeyframeId id{next_keyframe_++};
  Keyframe& keyframe = keyframes_[id];
  changed_keyframes_.add(id.value);
  keyframe.id = id;
  keyframe.frame = frame;
  keyframe.time = time;
  keyframe.T_map_cam = T_map_cam;
  return keyframe;
}

Landmark& SparseMap::addLandmark(const Eigen::Vector3d& position, KeyframeId reference,
                                 const stereo::StereoMeasurement& measurement) {
  const LandmarkId id{next_landmark_++};
  Landmark& landmark = landmarks_[id];
  landmark.id = id;
  landmark.position = position;
  landmark.reference = reference;
  observe(reference, id, measurement);
  return landmark;
}

void SparseMap::observe(KeyframeId keyframe, LandmarkId landmark,
                        const stereo::StereoMeasurement& measurement) {
  auto& observations = findToChange(landmark)->observations;
  auto after = observations.end();  // a loop is observed by a keyframe that is not the newest
  while (after != observations.begin() && keyframe < std::prev(after)->keyframe) --after;
  observations.insert(after, {keyframe, measurement});
  insertSorted(keyframeToChange(keyframe).landmarks, landmark);
}

void SparseMap::removeObservation(KeyframeId keyframe, LandmarkId landmark) {
  Landmark& of = *findToChange(landmark);
  auto& observations = of.observations;
  observations.erase(std::remove_if(observations.begin(), observations.end(),
                                    [&](const auto& o) { return o.keyframe == keyframe; }),
                     observations.end());
  eraseSorted(keyframeToChange(keyframe).landmarks, landmark);
  if (observations.empty() || of.reference == keyframe) removeLandmark(landmark);
}

void SparseMap::removeLandmark(LandmarkId landmark) {
  for (const LandmarkObservation& observation : findToChange(landmark)->observations) {
    eraseSorted(keyframeToChange(observation.keyframe).landmarks, landmark);
  }
  landmarks_.erase(landmark);
}

bool SparseMap::fuse(LandmarkId kept, LandmarkId gone) {
  const auto observations = find(gone)->observations;
  const bool sees_both = std::any_of(observations.begin(), observations.end(), [&](const auto& o) {
    const auto& seen = keyframes_.at(o.keyframe).landmarks;
    return std::binary_search(seen.begin(), seen.end(), kept);
  });
  if (sees_both) return false;
  removeLandmark(gone);
  for (const auto& [keyframe, measurement] : observations) observe(keyframe, kept, measurement);
  return true;
}

void SparseMap::removeKeyframe(KeyframeId keyframe) {
  const std::vector<LandmarkId> seen = keyframeToChange(keyframe).landmarks;
  for (const LandmarkId id : seen) {
    Landmark& landmark = *findToChange(id);
    if (landmark.reference == keyframe) reassignReference(landmark);
    removeObservation(keyframe, id);
  }
  bridgeOdometry(keyframes_.at(keyframe));
  keyframes_.erase(keyframe);
}

void SparseMap::bridgeOdometry(const Keyframe& removed) {
  const auto next = keyframes_.upper_bound(removed.id);
  if (next == keyframes_.end()) return;
  auto& odometry = next->second.odometry;
  if (!odometry || odometry->from != removed.id) return;
  if (removed.odometry) {
    odometry = composed(*removed.odometry, *odometry);
  } else {
    odometry.reset();
  }
}

void SparseMap::reassignReference(Landmark& landmark) {
  const Pose& T_map_old = keyframes_.at(landmark.reference).T_map_cam;
  const Keyframe* nearest = nullptr;
  double nearest_m = 0.0;
  for (const LandmarkObservation& observation : landmark.observations) {
    if (observation.keyframe == landmark.reference) continue;
    const Keyframe& keyframe = keyframes_.at(observation.keyframe);
    const double m = (keyframe.T_map_cam.translation() - T_map_old.translation()).norm();
    if (nearest == nullptr || m < nearest_m) {
      nearest = &keyframe;
      nearest_m = m;
    }
  }
  if (nearest == nullptr) return;
  const Pose T_nearest_old = nearest->T_map_cam.inverse(Eigen::Isometry) * T_map_old;
  landmark.T_reference_cut = T_nearest_old.cast<float>() * landmark.T_reference_cut;
  landmark.reference = nearest->id;
}

Landmark* SparseMap::findToChange(LandmarkId id) {
  const auto found = landmarks_.find(id);
  if (found == landmarks_.end()) return nullptr;
  changed_landmarks_.add(id.value);
  return &found->second;
}

const Landmark* SparseMap::find(LandmarkId id) const {
  const auto found = landmarks_.find(id);
  return found == landmarks_.end() ? nullptr : &found->second;
}

std::vector<int> SparseMap::submaps() const {
  std::set<int> submaps;
  for (const auto& [id, keyframe] : keyframes_) submaps.insert(keyframe.submap);
  return {submaps.begin(), submaps.end()};
}

const Keyframe& SparseMap::firstOf(int submap) const {
  const auto is_in = [submap](const auto& item) { return item.second.submap == submap; };
  const auto first = std::find_if(keyframes_.begin(), keyframes_.end(), is_in);
  if (first == keyframes_.end()) throw std::out_of_range("a submap without keyframes");
  return first->second;
}

int SparseMap::newSubmap() const {
  const auto used = submaps();
  return used.empty() ? 0 : used.back() + 1;
}

void SparseMap::joinSubmaps(int a, int b) {
  for (auto& [id, keyframe] : keyframes_) {
    if (keyframe.submap != std::max(a, b)) continue;
    keyframe.submap = std::min(a, b);
    changed_keyframes_.add(id.value);
    for (const LandmarkId landmark : keyframe.landmarks) changed_landmarks_.add(landmark.value);
  }
}

std::vector<KeyframeId> SparseMap::neighbourhood(KeyframeId of, int count) const {
  std::map<KeyframeId, int> shared;
  for (const LandmarkId id : keyframes_.at(of).landmarks) {
    for (const auto& observation : landmarks_.at(id).observations) ++shared[observation.keyframe];
  }
  return mostShared(of, std::move(shared), count);
}

SparseMap SparseMap::landmarksOnly(const std::vector<LandmarkId>& landmarks) const {
  SparseMap copy;
  copy.disparity_offset_px_ = disparity_offset_px_;
  copy.right_turn_ = right_turn_;
  for (const LandmarkId id : landmarks) {
    const Landmark& landmark = landmarks_.at(id);
    copy.landmarks_.emplace_hint(copy.landmarks_.end(), id, landmark);
    Keyframe& reference = copy.keyframes_[landmark.reference];
    reference.id = landmark.reference;
    reference.T_map_cam = keyframes_.at(landmark.reference).T_map_cam;
  }
  return copy;
}

std::vector<KeyframeId> mostShared(KeyframeId of, std::map<KeyframeId, int> shared, int count) {
  shared.erase(of);
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const auto& [id, landmarks] : shared) ranked.emplace_back(-landmarks, id);
  std::sort(ranked.begin(), ranked.end());
  std::vector<KeyframeId> result{of};
  for (const auto& [landmarks, id] : ranked) {
    if (static_cast<int>(result.size()) >= count) break;
    result.push_back(id);
  }
  std::sort(result.begin(), result.end());
  return result;
}

KeyframeId SparseMap::firstOfNewest(int count) const {
  KeyframeId first;
  for (auto at = keyframes_.rbegin(); at != keyframes_.rend() && count-- > 0; ++at) {
    first = at->first;
  }
  return first;
}

std::vector<LandmarkId> SparseMap::seenBy(const std::vector<KeyframeId>& keyframes) const {
  std::vector<LandmarkId> result;
  for (const KeyframeId id : keyframes) {
    const auto& seen = keyframes_.at(id).landmarks;
    result.insert(result.end(), seen.begin(), seen.end());
  }
  std::sort(result.begin(), result.end());
  result.erase(std::unique(result.begin(), result.end()), result.end());
  return result;
}

namespace {

/// Moves a landmark along the ray of its reference keyframe to its disparity there.
void placeByReference(const StereoCamera& camera, const SparseMap& map, Landmark& landmark) {
  const auto seen = std::find_if(
      landmark.observations.begin(), landmark.observations.end(),
      [&](const LandmarkObservation& one) { return one.keyframe == landmark.reference; });
  if (seen == landmark.observations.end() || !seen->measurement.stereo) return;
  const stereo::StereoMeasurement measured = map.corrected(seen->measurement);
  const auto point_cam =
      triangulate({measured.uv.x(), measured.uv.y(), measured.disparity}, camera);
  if (point_cam) landmark.position = map.keyframe(landmark.reference).T_map_cam * *point_cam;
}

}  // namespace

void turnRightCamera(const Eigen::Vector3d& angles, const StereoCamera& camera, SparseMap& map) {
  const Eigen::Vector3d before = map.rightTurn();
  if (angles.y() != before.y()) map.setDisparityOffset(0.0);
  std::vector<LandmarkId> ids;
  for (const auto& [id, landmark] : map.landmarks()) ids.push_back(id);
  for (const LandmarkId id : ids) {
    Landmark& landmark = *map.findToChange(id);
    for (auto& [keyframe, measurement] : landmark.observations) {
      if (!measurement.stereo) continue;
      measurement.disparity =
          stereo::turnedDisparity(measurement.uv, measurement.disparity, before, angles, camera);
    }
    placeByReference(camera, map, landmark);
  }
  map.setRightTurn(angles);
}

std::map<KeyframeId, double> scaleChanges(const std::map<KeyframeId, Pose>& before,
                                          const SparseMap& map) {
  constexpr double kLeastWay = 0.01;  // [m]; shorter ones tell no scale
  constexpr double kMostChange = 2.0;
  std::map<KeyframeId, double> ratios;
  const auto way = [](const Pose& a, const Pose& b) {
    return (a.translation() - b.translation()).norm();
  };
  for (auto at = before.begin(); at != before.end() && before.size() > 1; ++at) {
    auto from = at;
    if (std::next(at) == before.end()) --from;
    const auto to = std::next(from);
    const double old_way = way(from->second, to->second);
    if (old_way < kLeastWay) continue;
    const double new_way =
        way(map.keyframe(from->first).T_map_cam, map.keyframe(to->first).T_map_cam);
    ratios[at->first] = std::clamp(new_way / old_way, 1.0 / kMostChange, kMostChange);
  }
  return ratios;
}

}  // namespace headway::slam
