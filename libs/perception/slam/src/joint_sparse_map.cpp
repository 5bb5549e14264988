// SPDX-License-Identifier: BSD-3-Clause
// Joining maps: keyframes that are recognised in another map, the links that agree, and the map of
// both.
#include "joint_sparse_map.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "bundle_adjustment.h"
#include "keypoints.h"
#include "loop_closer.h"
#include "place_recognition.h"
#include "sparse_map.h"

namespace headway::slam {
namespace {

constexpr int kCandidates = 3;     ///< places of other maps that are compared with a keyframe
constexpr double kMinSigma = 2.0;  ///< of a measurement against a pose by descriptors alone [px]

/// Landmarks that a keyframe sees, as it sees them.
struct SeenLandmarks {
  std::vector<const Landmark*> landmarks;
  std::vector<DescribedPoint> points;
  std::vector<stereo::StereoMeasurement> measurements;
};

SeenLandmarks seenIn(const Keyframe& keyframe, const SparseMap& map) {
  SeenLandmarks seen;
  for (const LandmarkId id : keyframe.landmarks) {
    const Landmark* landmark = map.find(id);
    if (landmark->descriptor == Descriptor{}) continue;
    for (const auto& [observer, measurement] : landmark->observations) {
      if (observer != keyframe.id) continue;
      seen.landmarks.push_back(landmark);
      seen.points.push_back({measurement.uv, landmark->descriptor});
      seen.measurements.push_back(map.corrected(measurement));
    }
  }
  return seen;
}

/// Pairs of landmarks (of another map, index of the seen one) that are measured at one place from a
/// pose, most similar ones first; each landmark occurs once.
std::vector<std::pair<const Landmark*, std::size_t>> sameLandmarks(
    const Pose& T_map_cam, const std::vector<LandmarkId>& among, const SeenLandmarks& seen,
    const SparseMap& map, const StereoCamera& camera) {
  using Candidate = std::tuple<int, const Landmark*, std::size_t>;
  const Pose T_cam_map = T_map_cam.inverse(Eigen::Isometry);
  std::vector<Candidate> candidates;
  for (const LandmarkId id : among) {
    const Landmark* landmark = map.find(id);
    const Eigen::Vector3d point = T_cam_map * landmark->position;
    if (landmark->descriptor == Descriptor{} || point.z() <= 0.0) continue;
    for (std::size_t i = 0; i < seen.points.size(); ++i) {
      auto measurement = seen.measurements[i];
      measurement.sigma_px = std::max(measurement.sigma_px, kMinSigma);
      measurement.sigma_disparity_px = std::max(measurement.sigma_disparity_px, kMinSigma);
      const auto residual = stereo::stereoResidual(point, measurement, camera, nullptr);
      if (residual.squaredNorm() > chiSquare99(3)) continue;
      const int bits = distance(landmark->descriptor, seen.points[i].descriptor);
      if (bits <= kMaxDescriptorDistance) candidates.emplace_back(bits, landmark, i);
    }
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    const auto key = [](const Candidate& of) {
      return std::tuple(std::get<0>(of), std::get<1>(of)->id, std::get<2>(of));
    };
    return key(a) < key(b);
  });
  std::set<LandmarkId> used;
  std::vector<bool> taken(seen.points.size(), false);
  std::vector<std::pair<const Landmark*, std::size_t>> pairs;
  for (const auto& [bits, landmark, i] : candidates) {
    if (taken[i] || !used.insert(landmark->id).second) continue;
    taken[i] = true;
    pairs.emplace_back(landmark, i);
  }
  return pairs;
}

/// The keyframe in the surroundings of a place, if enough of their landmarks are the same.
std::optional<MapLink> linkTo(KeyframeId place, const Keyframe& keyframe, const SeenLandmarks& seen,
                              const SparseMap& map, const StereoCamera& camera,
                              const SlamParams& params) {
  const auto among = map.seenBy(map.neighbourhood(place, params.window));
  const auto initial =
      relocalise(seen.points, among, map, camera, params.min_inliers / 2).T_map_cam;
  if (!initial) return std::nullopt;
  const auto pairs = sameLandmarks(*initial, among, seen, map, camera);
  std::vector<stereo::PoseConstraint> constraints;
  for (const auto& [landmark, i] : pairs) {
    constraints.push_back({landmark->position, seen.measurements[i], true, true});
  }
  const auto refined = stereo::refinePose(*initial, constraints, camera, {4.0, 3, 6});
  if (!refined || refined->inliers < params.min_inliers) return std::nullopt;
  MapLink link{keyframe.id,
               place,
               map.keyframe(place).T_map_cam.inverse(Eigen::Isometry) * refined->T_map_cam,
               {}};
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    if (!constraints[k].inlier || !constraints[k].stereo_inlier) continue;
    link.landmarks.emplace_back(pairs[k].first->id, seen.landmarks[pairs[k].second]->id);
  }
  return link;
}

/// Whether two links of the same maps agree, as far as drift between them allows.
bool agree(const MapLink& a, const MapLink& b, const SparseMap& map) {
  constexpr double kFloorM = 0.5;
  constexpr double kMaxTurn = 0.05;  ///< [rad]
  const auto between = [&map](KeyframeId from, KeyframeId to) {
    return Pose(map.keyframe(from).T_map_cam.inverse(Eigen::Isometry) * map.keyframe(to).T_map_cam);
  };
  const Pose T_keyframes = between(a.keyframe, b.keyframe);
  const Pose T_places = between(a.place, b.place);
  const Pose by_b = T_places * b.T_place_keyframe * T_keyframes.inverse(Eigen::Isometry);
  const Pose difference = a.T_place_keyframe.inverse(Eigen::Isometry) * by_b;
  const double apart = T_keyframes.translation().norm() + T_places.translation().norm();
  return difference.translation().norm() < kFloorM + kMaxDrift * apart &&
         logSo3(difference.linear()).norm() < kMaxTurn * (1.0 + 0.1 * apart);
}

}  // namespace

std::size_t SeparateMaps::mapOf(KeyframeId keyframe) const {
  const auto next = std::upper_bound(first.begin(), first.end(), keyframe);
  return static_cast<std::size_t>(next - first.begin()) - 1;
}

std::vector<MapLink> consistentLinks(std::vector<MapLink> links, const SeparateMaps& maps) {
  constexpr std::size_t kMinConfirmations = 2;
  const auto sameMaps = [&](const MapLink& a, const MapLink& b) {
    return maps.mapOf(a.keyframe) == maps.mapOf(b.keyframe) &&
           maps.mapOf(a.place) == maps.mapOf(b.place);
  };
  std::vector<std::pair<std::size_t, std::size_t>> confirmed;  // confirmations, index
  for (std::size_t i = 0; i < links.size(); ++i) {
    std::set<KeyframeId> by;
    for (const MapLink& other : links) {
      if (other.keyframe == links[i].keyframe || !sameMaps(links[i], other)) continue;
      if (agree(links[i], other, maps.all)) by.insert(other.keyframe);
    }
    if (by.size() >= kMinConfirmations) confirmed.emplace_back(by.size(), i);
  }
  std::stable_sort(confirmed.begin(), confirmed.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<std::size_t> kept;
  for (const auto& confirmation : confirmed) {
    const std::size_t i = confirmation.second;
    const bool contradicts = std::any_of(kept.begin(), kept.end(), [&](std::size_t k) {
      return sameMaps(links[i], links[k]) && !agree(links[i], links[k], maps.all);
    });
    if (!contradicts) kept.push_back(i);
  }
  std::sort(kept.begin(), kept.end());
  std::vector<MapLink> consistent;
  for (const std::size_t i : kept) consistent.push_back(std::move(links[i]));
  return consistent;
}

namespace {

/// Recognises keyframes in the maps before their own one, by ascending keyframe.
///
/// Each keyframe's landmarks are compared with those around the keyframes that resemble it most:
/// descriptors propose a pose, and the landmarks must then be measured where the other map's lie,
/// with the same disparity.
std::vector<MapLink> findMapLinks(const SeparateMaps& maps, const StereoCamera& camera,
                                  const SlamParams& params) {
  PlaceIndex index;
  for (const auto& [id, keyframe] : maps.all.keyframes()) {
    if (keyframe.submap != 0) continue;  // its place in its own map is not known
    index.add(id, descriptorsOf(seenIn(keyframe, maps.all).points));
  }
  std::vector<MapLink> links;
  for (const auto& [id, keyframe] : maps.all.keyframes()) {
    const std::size_t own = maps.mapOf(id);
    if (own == 0 || keyframe.submap != 0) continue;
    const SeenLandmarks seen = seenIn(keyframe, maps.all);
    const auto is_other = [&](KeyframeId other) { return maps.mapOf(other) < own; };
    for (const auto& match : index.query(descriptorsOf(seen.points), kCandidates, is_other)) {
      auto link = linkTo(match.keyframe, keyframe, seen, maps.all, camera, params);
      if (link) links.push_back(std::move(*link));
    }
  }
  return consistentLinks(std::move(links), maps);
}

template <typename Id>
Id shifted(Id id, std::int64_t by) {
  id.value += by;
  return id;
}

/// Puts maps side by side, with new ids.
class MapCollector {
 public:
  explicit MapCollector(const StereoCamera& camera) : camera_(camera) {}

  /// @return id of each keyframe in the collection less its own id
  std::int64_t add(const SparseMap& given) {
    std::optional<SparseMap> turned;
    if (!given.keyframes().empty()) {
      if (!right_turn_) right_turn_ = given.rightTurn();
      if (given.rightTurn() != *right_turn_) {
        turned = given;
        turnRightCamera(*right_turn_, camera_, *turned);
      }
    }
    const SparseMap& map = turned ? *turned : given;
    const std::int64_t shift = next_keyframe_;
    const std::int64_t landmark_shift = next_landmark_;
    const int submap_shift = next_submap_;
    for (const auto& [id, keyframe] : map.keyframes()) {
      Keyframe& added = keyframes_.emplace_back(keyframe);
      added.id = shifted(id, shift);
      if (added.submap != 0) added.submap += submap_shift;
      next_submap_ = std::max(next_submap_, added.submap);
      if (added.odometry) added.odometry->from = shifted(added.odometry->from, shift);
      next_keyframe_ = added.id.value + 1;
    }
    for (const auto& [id, landmark] : map.landmarks()) {
      Landmark& added = landmarks_.emplace_back(landmark);
      added.id = shifted(id, landmark_shift);
      added.reference = shifted(landmark.reference, shift);
      for (auto& seen : added.observations) seen.keyframe = shifted(seen.keyframe, shift);
      next_landmark_ = added.id.value + 1;
    }
    first_.push_back(KeyframeId{shift});
    offset_sum_px_ += static_cast<double>(map.keyframes().size()) * map.disparityOffset();
    return shift;
  }

  [[nodiscard]] SeparateMaps maps() const {
    SeparateMaps maps{SparseMap(keyframes_, landmarks_), first_};
    if (!keyframes_.empty()) {
      maps.all.setDisparityOffset(offset_sum_px_ / static_cast<double>(keyframes_.size()));
      maps.all.setRightTurn(*right_turn_);
    }
    return maps;
  }

 private:
  StereoCamera camera_;
  std::vector<Keyframe> keyframes_;
  std::vector<Landmark> landmarks_;
  std::vector<KeyframeId> first_;
  std::int64_t next_keyframe_ = 0;
  std::int64_t next_landmark_ = 0;
  int next_submap_ = 0;  ///< greatest number so far
  double offset_sum_px_ = 0.0;
  std::optional<Eigen::Vector3d> right_turn_;  ///< of the first map with keyframes
};

/// Indices of the maps in an order that depends on their contents only.
std::vector<std::size_t> orderByContents(const std::vector<const SparseMap*>& maps) {
  const auto key = [&maps](std::size_t at) {
    const SparseMap& map = *maps[at];
    if (map.keyframes().empty()) return std::tuple(0.0, 0.0, std::size_t{0}, 0.0, 0.0);
    const Keyframe& last = map.keyframes().rbegin()->second;
    return std::tuple(map.keyframes().begin()->second.time, last.time, map.landmarks().size(),
                      last.T_map_cam.translation().x(), last.T_map_cam.translation().y());
  };
  std::vector<std::size_t> order(maps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
  return order;
}

/// Some of the maps; they keep their places and ids.
SeparateMaps only(const std::vector<bool>& wanted, const SeparateMaps& maps) {
  std::vector<Keyframe> keyframes;
  std::vector<Landmark> landmarks;
  for (const auto& [id, keyframe] : maps.all.keyframes()) {
    if (wanted[maps.mapOf(id)]) keyframes.push_back(keyframe);
  }
  for (const auto& [id, landmark] : maps.all.landmarks()) {
    if (wanted[maps.mapOf(landmark.reference)]) landmarks.push_back(landmark);
  }
  SeparateMaps result{SparseMap(keyframes, landmarks), maps.first};
  result.all.setDisparityOffset(maps.all.disparityOffset());
  result.all.setRightTurn(maps.all.rightTurn());
  return result;
}

void moveMaps(const std::vector<Pose>& moves, SeparateMaps& maps) {
  std::map<KeyframeId, Pose> poses;
  for (const auto& [id, keyframe] : maps.all.keyframes()) {
    poses[id] = normalized(Pose(moves[maps.mapOf(id)] * keyframe.T_map_cam));
  }
  applyCorrection(poses, maps.all);
}

/// Moves each map onto one that is placed already, by the link with most landmarks.
void alignMaps(const std::vector<MapLink>& links, SeparateMaps& maps) {
  std::vector<Pose> moves(maps.first.size(), Pose::Identity());
  std::set<std::size_t> placed;
  if (!links.empty()) placed.insert(maps.mapOf(links.front().place));
  while (true) {
    const MapLink* best = nullptr;
    for (const MapLink& link : links) {
      const auto count =
          placed.count(maps.mapOf(link.keyframe)) + placed.count(maps.mapOf(link.place));
      if (count != 1) continue;
      if (best == nullptr || link.landmarks.size() > best->landmarks.size()) best = &link;
    }
    if (best == nullptr) break;
    const std::size_t a = maps.mapOf(best->place);
    const std::size_t b = maps.mapOf(best->keyframe);
    const Pose T_a_b = maps.all.keyframe(best->place).T_map_cam * best->T_place_keyframe *
                       maps.all.keyframe(best->keyframe).T_map_cam.inverse(Eigen::Isometry);
    if (placed.count(a) > 0) {
      moves[b] = moves[a] * T_a_b;
    } else {
      moves[a] = moves[b] * T_a_b.inverse(Eigen::Isometry);
    }
    placed.insert({a, b});
  }
  moveMaps(moves, maps);
}

std::vector<ClosedLoop> loopsOf(const std::vector<MapLink>& links) {
  std::vector<ClosedLoop> loops;
  for (const MapLink& link : links) {
    loops.push_back({link.keyframe, link.place, link.T_place_keyframe, {}});
  }
  return loops;
}

void fuseLandmarks(const std::vector<MapLink>& links, SparseMap& map) {
  std::map<LandmarkId, LandmarkId> fused;  // gone, kept
  const auto present = [&fused](LandmarkId id) {
    for (auto at = fused.find(id); at != fused.end(); at = fused.find(id)) id = at->second;
    return id;
  };
  for (const MapLink& link : links) {
    for (const auto& [at_place, in_keyframe] : link.landmarks) {
      const LandmarkId kept = present(at_place);
      const LandmarkId gone = present(in_keyframe);
      if (kept != gone && map.fuse(kept, gone)) fused[gone] = kept;
    }
  }
}

void adjustAll(const StereoCamera& camera, const StopCondition& stop, SparseMap& map) {
  constexpr int kRounds = 2;  // the second without the outliers of the first
  constexpr int kIterations = 10;
  std::vector<KeyframeId> all;
  for (const auto& [id, keyframe] : map.keyframes()) all.push_back(id);
  for (int round = 0; round < kRounds; ++round) {
    (void)adjustBundle(map, all, camera, kIterations, stop);
  }
}

std::size_t keyframesOf(const std::vector<MapLink>& links) {
  std::set<KeyframeId> keyframes;
  for (const MapLink& link : links) keyframes.insert(link.keyframe);
  return keyframes.size();
}

/// Puts the first keyframe of the group's first map where it is in its own map.
void moveToFirst(const SparseMap& first_map, std::int64_t shift, SeparateMaps& maps) {
  if (first_map.keyframes().empty()) return;
  const auto& [id, first] = *first_map.keyframes().begin();
  const Pose& now = maps.all.keyframe(shifted(id, shift)).T_map_cam;
  const Pose move = first.T_map_cam * now.inverse(Eigen::Isometry);
  moveMaps(std::vector<Pose>(maps.first.size(), move), maps);
}

/// Moves maps onto each other by the links between them, fuses landmarks that are the same, and
/// adjusts the whole.
void joinByLinks(const std::vector<MapLink>& links, const StereoCamera& camera, SeparateMaps& maps,
                 const StopCondition& stop) {
  alignMaps(links, maps);
  applyCorrection(posesWithLoops(maps.all.keyframes(), loopsOf(links), stop), maps.all);
  fuseLandmarks(links, maps.all);
  adjustAll(camera, stop, maps.all);
}

/// Makes the map of a group whose members are known.
void makeMap(const std::vector<MapLink>& links, const StereoCamera& camera,
             const StopCondition& stop, const std::vector<const SparseMap*>& maps,
             const SeparateMaps& separate, JointSparseMap& group) {
  std::vector<bool> wanted(maps.size(), false);
  for (std::size_t i = 0; i < group.members.size(); ++i) {
    const SparseMap& map = *maps[group.members[i]];
    if (map.keyframes().empty()) continue;
    wanted[separate.mapOf(shifted(map.keyframes().begin()->first, group.shifts[i]))] = true;
  }
  SeparateMaps own = only(wanted, separate);
  if (group.members.size() > 1) {
    std::vector<MapLink> of_group;
    for (const MapLink& link : links) {
      if (wanted[separate.mapOf(link.keyframe)]) of_group.push_back(link);
    }
    group.links = keyframesOf(of_group);
    joinByLinks(of_group, camera, own, stop);
    moveToFirst(*maps[group.members.front()], group.shifts.front(), own);
  }
  group.map = std::move(own.all);
}

}  // namespace

std::vector<JointSparseMap> joinSparseMaps(const std::vector<const SparseMap*>& maps,
                                           const StereoCamera& camera, const SlamParams& params) {
  MapCollector collector(camera);
  std::vector<std::size_t> place_of(maps.size());  // in the collection
  std::vector<std::int64_t> shift_of(maps.size());
  std::size_t place = 0;
  for (const std::size_t at : orderByContents(maps)) {
    place_of[at] = place++;
    shift_of[at] = collector.add(*maps[at]);
  }
  const SeparateMaps separate = collector.maps();
  const auto links = findMapLinks(separate, camera, params);
  DisjointSets groups(maps.size());
  for (const MapLink& link : links) {
    groups.join(separate.mapOf(link.place), separate.mapOf(link.keyframe));
  }
  std::map<std::size_t, JointSparseMap> joint;  // by the group's number
  std::vector<JointSparseMap> result;
  for (std::size_t at = 0; at < maps.size(); ++at) {
    JointSparseMap& of = joint[groups.of(place_of[at])];
    of.members.push_back(at);
    of.shifts.push_back(shift_of[at]);
  }
  for (auto& [group, of] : joint) {
    result.push_back(std::move(of));
    makeMap(links, camera, params.stop, maps, separate, result.back());
  }
  std::sort(result.begin(), result.end(), [](const JointSparseMap& a, const JointSparseMap& b) {
    return a.members.front() < b.members.front();
  });
  return result;
}

}  // namespace headway::slam
