// SPDX-License-Identifier: BSD-3-Clause
#include "loop_closer.h"

#include <algorithm>
#include <iterator>
#include <limits>

#include "disjoint_sets.h"
#include "relocaliser.h"

namespace headway::slam {
namespace {

constexpr int kMinAge = 20;          ///< keyframes between a place and its return, at least
constexpr double kDrift = 0.05;      ///< maximum drift over path length [-]
constexpr double kDriftFloor = 1.0;  ///< minimum of the maximum drift [m]

std::vector<Descriptor> descriptorsOf(KeyframeId keyframe, const SparseMap& map) {
  std::vector<Descriptor> descriptors;
  for (const LandmarkId id : map.keyframe(keyframe).landmarks) {
    descriptors.push_back(map.find(id)->descriptor);
  }
  return descriptors;
}

std::vector<Descriptor> descriptorsOf(const std::vector<DescribedPoint>& points) {
  std::vector<Descriptor> descriptors;
  for (const DescribedPoint& point : points) descriptors.push_back(point.descriptor);
  return descriptors;
}

/// Disjoint sets of keyframes.
class KeyframeGroups {
 public:
  explicit KeyframeGroups(const std::map<KeyframeId, Keyframe>& keyframes)
      : sets_(keyframes.size()) {
    for (const auto& [id, keyframe] : keyframes) ids_.push_back(id);
  }
  /// A number that all keyframes of one set have in common.
  [[nodiscard]] std::size_t of(KeyframeId id) { return sets_.of(indexOf(id)); }
  void join(KeyframeId a, KeyframeId b) { sets_.join(indexOf(a), indexOf(b)); }

 private:
  [[nodiscard]] std::size_t indexOf(KeyframeId id) const {
    return static_cast<std::size_t>(std::lower_bound(ids_.begin(), ids_.end(), id) - ids_.begin());
  }

  std::vector<KeyframeId> ids_;  ///< ascending
  DisjointSets sets_;
};

/// Keyframes that no chain of shared landmarks connects to the newest one, so that their distance
/// is unknown, ascending.
std::vector<KeyframeId> unrelatedTo(KeyframeId newest, const SparseMap& map) {
  const auto& keyframes = map.keyframes();
  const auto apart = [](const auto& a, const auto& b) {
    return shareNoLandmarks(a.second, b.second);
  };
  if (std::adjacent_find(keyframes.begin(), keyframes.end(), apart) == keyframes.end()) return {};
  KeyframeGroups groups(keyframes);
  for (const auto& [id, landmark] : map.landmarks()) {
    const KeyframeId first = landmark.observations.front().keyframe;
    for (const LandmarkObservation& other : landmark.observations) {
      groups.join(first, other.keyframe);
    }
  }
  std::vector<KeyframeId> unrelated;
  for (const auto& [id, keyframe] : keyframes) {
    if (groups.of(id) != groups.of(newest)) unrelated.push_back(id);
  }
  return unrelated;
}

}  // namespace

void LoopCloser::index(KeyframeId keyframe, const SparseMap& map) {
  index_.add(keyframe, descriptorsOf(keyframe, map));
}

std::optional<TrackedPose> LoopCloser::locate(const TrackingFrame& frame, SparseMap& map,
                                              KeyframeId* keyframe) const {
  constexpr int kCandidates = 5;
  const auto points = describe(frame);
  for (const auto& match :
       index_.query(descriptorsOf(points), kCandidates, [](KeyframeId) { return true; })) {
    const auto among = map.seenBy(map.neighbourhood(match.keyframe, params_.window));
    // Few matches suffice: the pose is verified by measuring patches from there.
    const auto initial = relocalise(points, among, map, camera_, params_.min_inliers / 2).T_map_cam;
    if (!initial) continue;
    auto tracked = tracker_.measureLocalMap(frame, *initial, among, map, params_.min_inliers);
    if (!tracked) continue;
    *keyframe = match.keyframe;
    return tracked;
  }
  return std::nullopt;
}

std::vector<KeyframeId> LoopCloser::findLoopCandidates(KeyframeId newest,
                                                       const SparseMap& map) const {
  constexpr double kMaxTurn = 0.8;  ///< between the views [rad]
  const auto near = map.neighbourhood(newest, 1 << 20);
  const Pose& T_map_cam = map.keyframe(newest).T_map_cam;
  std::vector<KeyframeId> old = unrelatedTo(newest, map);
  double path = 0.0;
  Eigen::Vector3d after = T_map_cam.translation();
  for (auto at = map.keyframes().rbegin(); at != map.keyframes().rend(); ++at) {
    const Pose& T_map_old = at->second.T_map_cam;
    path += (T_map_old.translation() - after).norm();
    after = T_map_old.translation();
    const bool aged = at->first.value + kMinAge < newest.value &&
                      !std::binary_search(near.begin(), near.end(), at->first);
    const bool reachable = (after - T_map_cam.translation()).norm() < kDriftFloor + kDrift * path;
    const double facing = T_map_old.linear().col(2).dot(T_map_cam.linear().col(2));
    if (aged && reachable && facing > std::cos(kMaxTurn)) old.push_back(at->first);
  }
  std::sort(old.begin(), old.end());
  old.erase(std::unique(old.begin(), old.end()), old.end());
  return old;
}

LoopCandidate LoopCloser::candidateOf(KeyframeId newest, KeyframeId old,
                                      const SparseMap& map) const {
  LoopCandidate candidate;
  candidate.attempt.keyframe = newest;
  candidate.attempt.candidate = old;
  candidate.attempt.joins_submaps = map.submapOf(newest) != map.submapOf(old);
  candidate.T_map_newest = map.keyframe(newest).T_map_cam;
  candidate.T_map_old = map.keyframe(old).T_map_cam;
  candidate.among = map.seenBy(map.neighbourhood(old, params_.window));
  candidate.offset_allowed_m = allowedOffset(newest, old, map);
  return candidate;
}

std::optional<ClosedLoop> LoopCloser::verify(const TrackingFrame& frame,
                                             const std::vector<DescribedPoint>& points,
                                             LoopCandidate& candidate, SparseMap& map) const {
  LoopAttempt& attempt = candidate.attempt;
  const auto recognised = relocalise(points, candidate.among, map, camera_, params_.min_inliers);
  attempt.outcome = LoopOutcome::kNotRecognised;
  attempt.inliers = recognised.inliers;
  attempt.inliers_needed = params_.min_inliers;
  if (!recognised.T_map_cam) return std::nullopt;
  auto seen_from = tracker_.measureLocalMap(frame, *recognised.T_map_cam, candidate.among, map, 0);
  attempt.outcome = LoopOutcome::kTooFewInliers;
  attempt.inliers = seen_from ? static_cast<int>(seen_from->landmarks.size()) : 0;
  attempt.inliers_needed = 3 * params_.min_inliers;
  if (attempt.inliers < attempt.inliers_needed) return std::nullopt;
  attempt.offset_m =
      (seen_from->T_map_cam.translation() - candidate.T_map_newest.translation()).norm();
  attempt.offset_allowed_m = candidate.offset_allowed_m;
  attempt.outcome = LoopOutcome::kTooFarOff;
  if (attempt.offset_m > attempt.offset_allowed_m) return std::nullopt;
  attempt.outcome = LoopOutcome::kClosed;
  return ClosedLoop{attempt.keyframe, attempt.candidate,
                    candidate.T_map_old.inverse(Eigen::Isometry) * seen_from->T_map_cam,
                    std::move(seen_from->landmarks)};
}

/// How far drift may have moved the new keyframe from where the old one sees it.
double LoopCloser::allowedOffset(KeyframeId newest, KeyframeId old, const SparseMap& map) const {
  const auto anywhere = unrelatedTo(newest, map);
  if (std::binary_search(anywhere.begin(), anywhere.end(), old)) {
    return std::numeric_limits<double>::infinity();
  }
  double path = 0.0;
  Eigen::Vector3d last = map.keyframe(old).T_map_cam.translation();
  for (auto at = map.keyframes().find(old); at != map.keyframes().end(); ++at) {
    path += (at->second.T_map_cam.translation() - last).norm();
    last = at->second.T_map_cam.translation();
  }
  return kDriftFloor + kDrift * path;
}

std::vector<LoopAttempt> LoopCloser::close(const TrackingFrame& frame, KeyframeId newest,
                                           SparseMap& map) const {
  std::vector<LoopAttempt> attempts;
  if (newest.value % kSpacing != 0) return attempts;
  const auto old = findLoopCandidates(newest, map);
  if (old.empty()) return attempts;
  const auto points = describe(frame);
  for (const KeyframeId keyframe : mostAlike(points, old)) {
    LoopCandidate candidate = candidateOf(newest, keyframe, map);
    const auto loop = verify(frame, points, candidate, map);
    attempts.push_back(candidate.attempt);
    if (!loop) continue;
    adjuster_.abandon();
    applyCorrection(posesWithLoop(keyframesOfLoop(newest, keyframe, map), *loop, params_.stop),
                    map);
    map.joinSubmaps(map.submapOf(newest), map.submapOf(keyframe));
    adjustAll(*loop, map);
    break;
  }
  return attempts;
}

std::vector<DescribedPoint> LoopCloser::describe(const TrackingFrame& frame) {
  return detectAndDescribe(frame.left.levels.front(), kCorners, frame.excluded);
}

std::vector<KeyframeId> LoopCloser::mostAlike(const std::vector<DescribedPoint>& points,
                                              const std::vector<KeyframeId>& among) const {
  constexpr int kCandidates = 2;
  const auto wanted = [&](KeyframeId id) {
    return std::binary_search(among.begin(), among.end(), id);
  };
  std::vector<KeyframeId> alike;
  for (const auto& match : index_.query(descriptorsOf(points), kCandidates, wanted)) {
    alike.push_back(match.keyframe);
  }
  return alike;
}

/// Adds the loop's measurements, then adjusts the whole submap.
void LoopCloser::adjustAll(const ClosedLoop& loop, SparseMap& map) const {
  constexpr int kGlobalIterations = 8;
  if (map.keyframes().count(loop.newest) == 0) return;
  observeLoop(loop, map);
  std::vector<KeyframeId> all;
  for (const auto& [id, keyframe] : map.keyframes()) {
    if (keyframe.submap == map.submapOf(loop.newest)) all.push_back(id);
  }
  adjuster_.adjust(map, all, kGlobalIterations);
}

}  // namespace headway::slam
