// SPDX-License-Identifier: BSD-3-Clause
// Loop closing: search for places seen before, verification, and correction of the map.
#include "loop_closer.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <future>
#include <iterator>
#include <limits>
#include <set>
#include <unordered_map>
#include <utility>

#include "place_check.h"
#include "place_recognition.h"
#include "wheel_odometry.h"

namespace headway::slam {
namespace {

/// Standard deviations of the relative pose of two keyframes. All edges have them, those of loops
/// as well, so that only their growth with the way and their ratio to each other count.
struct EdgeNoise {
  double floor_m = 0.005;
  double per_m = 0.01;  ///< of the way [m/m]
  double floor_rad = 0.0005;
  double rad_per_m = 0.0005;  ///< of the way [rad/m]
};

PoseGraphEdge edgeBetween(const Keyframe& a, const Keyframe& b) {
  constexpr EdgeNoise kEdge;
  PoseGraphEdge edge;
  edge.a = a.id;
  edge.b = b.id;
  edge.T_a_b = a.T_map_cam.inverse(Eigen::Isometry) * b.T_map_cam;
  const double length = edge.T_a_b.translation().norm();
  edge.sigma_m = kEdge.floor_m + kEdge.per_m * length;
  edge.sigma_rad = kEdge.floor_rad + kEdge.rad_per_m * length;
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

/// Whether two consecutive keyframes share no landmark: the camera was lost between them, so their
/// relative pose is only predicted.
bool shareNoLandmarks(const Keyframe& a, const Keyframe& b) {
  auto at_a = a.landmarks.begin();
  auto at_b = b.landmarks.begin();
  while (at_a != a.landmarks.end() && at_b != b.landmarks.end()) {
    if (*at_a == *at_b) return false;
    *at_a < *at_b ? ++at_a : ++at_b;
  }
  return true;
}

/// Copies of the keyframes that a loop may move: those of both submaps.
std::map<KeyframeId, Keyframe> keyframesOfLoop(KeyframeId newest, KeyframeId old,
                                               const SparseMap& map) {
  std::map<KeyframeId, Keyframe> members;
  for (const auto& [id, keyframe] : map.keyframes()) {
    if (keyframe.submap != map.submapOf(newest) && keyframe.submap != map.submapOf(old)) continue;
    members.emplace_hint(members.end(), id, keyframe);
  }
  return members;
}

/// Adds the loop's measurements to the newest keyframe, which must be in the map.
void observeLoop(const ClosedLoop& loop, SparseMap& map) {
  const std::vector<LandmarkId> seen = map.keyframe(loop.newest).landmarks;
  for (const TrackedLandmark& landmark : loop.landmarks) {
    if (map.find(landmark.id) == nullptr) continue;
    if (std::binary_search(seen.begin(), seen.end(), landmark.id)) continue;
    map.observe(loop.newest, landmark.id, landmark.measurement);
  }
}

}  // namespace

std::vector<PoseGraphEdge> edgesOf(const std::map<KeyframeId, Keyframe>& keyframes) {
  constexpr int kNeighbours = 5;  ///< of a keyframe, itself included: the graph stays sparse
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

namespace {

constexpr int kMinAge = 20;          ///< keyframes between a place and its return, at least
constexpr double kDriftFloor = 1.0;  ///< minimum of the maximum drift [m]
constexpr double kNear_m = 5.0;      ///< a place given by hand and the way to the next keyframe

std::vector<Descriptor> descriptorsOf(KeyframeId keyframe, const SparseMap& map) {
  std::vector<Descriptor> descriptors;
  for (const LandmarkId id : map.keyframe(keyframe).landmarks) {
    descriptors.push_back(map.find(id)->descriptor);
  }
  return descriptors;
}

/// Keyframes that no chain of shared landmarks connects to the newest one, so that their distance
/// is unknown, ascending.
std::vector<KeyframeId> unrelatedTo(KeyframeId newest, const SparseMap& map) {
  const auto& keyframes = map.keyframes();
  const auto apart = [](const auto& a, const auto& b) {
    return shareNoLandmarks(a.second, b.second);
  };
  if (std::adjacent_find(keyframes.begin(), keyframes.end(), apart) == keyframes.end()) return {};
  std::vector<KeyframeId> ids;
  for (const auto& [id, keyframe] : keyframes) ids.push_back(id);
  const auto indexOf = [&ids](KeyframeId id) {
    return static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  };
  DisjointSets groups(ids.size());
  for (const auto& [id, landmark] : map.landmarks()) {
    const std::size_t first = indexOf(landmark.observations.front().keyframe);
    for (const LandmarkObservation& other : landmark.observations) {
      groups.join(first, indexOf(other.keyframe));
    }
  }
  std::vector<KeyframeId> unrelated;
  for (const KeyframeId id : ids) {
    if (groups.of(indexOf(id)) != groups.of(indexOf(newest))) unrelated.push_back(id);
  }
  return unrelated;
}

}  // namespace

void LoopCloser::index(KeyframeId keyframe, const SparseMap& map) {
  index_.add(keyframe, descriptorsOf(keyframe, map));
}

bool LoopCloser::isNearExpected(KeyframeId keyframe, const SparseMap& map) const {
  if (!expected_) return false;
  const Pose T_expected_key =
      expected_->inverse(Eigen::Isometry) * map.keyframe(keyframe).T_map_cam;
  return T_expected_key.translation().norm() < kNear_m && T_expected_key(2, 2) > 0.0;
}

std::vector<LocatedCamera> LoopCloser::locate(const TrackingFrame& frame, std::optional<int> turn,
                                              const SparseMap& map) const {
  const auto points = describe(frame);
  if (expected_) {
    const auto is_near = [&](KeyframeId id) { return isNearExpected(id, map); };
    auto places = placesAmong(is_near, turn, frame, points, 2.0 * kNear_m, map);
    if (!places.empty()) return places;
  }
  const auto isAnywhere = [](KeyframeId /*id*/) { return true; };
  return placesAmong(isAnywhere, turn, frame, points, HUGE_VAL, map);
}

std::optional<LocatedCamera> LoopCloser::locateAt(const PlaceCheck::Place& place,
                                                  const TrackingFrame& frame,
                                                  const SparseMap& map) const {
  if (map.keyframes().count(place.keyframe) == 0) return std::nullopt;
  return confirmed(place.T_map_cam, place.keyframe,
                   map.seenBy(map.neighbourhood(place.keyframe, params_.window)), frame, HUGE_VAL,
                   map);
}

std::vector<KeyframeId> LoopCloser::candidates(const std::vector<DescribedPoint>& points,
                                               const std::function<bool(KeyframeId)>& wanted,
                                               std::optional<int> turn,
                                               const SparseMap& map) const {
  constexpr std::size_t kEach = 5;
  const int all = std::numeric_limits<int>::max();
  std::vector<KeyframeId> places;
  std::set<LandmarkId> shown;
  for (const PlaceMatch& match : index_.query(descriptorsOf(points), all, wanted)) {
    if (places.size() == 4 * kEach) break;
    const auto& seen = map.keyframe(match.keyframe).landmarks;
    const auto again =
        std::count_if(seen.begin(), seen.end(), [&](LandmarkId id) { return shown.count(id) > 0; });
    if (2 * static_cast<std::size_t>(again) > seen.size()) continue;
    places.push_back(match.keyframe);
    shown.insert(seen.begin(), seen.end());
  }
  if (!turn || places.size() <= kEach) return places;
  const std::size_t turns = (places.size() + kEach - 1) / kEach;
  const std::size_t first = static_cast<std::size_t>(*turn) % turns * kEach;
  const std::size_t end = std::min(first + kEach, places.size());
  return {places.begin() + static_cast<std::ptrdiff_t>(first),
          places.begin() + static_cast<std::ptrdiff_t>(end)};
}

std::vector<LocatedCamera> LoopCloser::placesAmong(const std::function<bool(KeyframeId)>& wanted,
                                                   std::optional<int> turn,
                                                   const TrackingFrame& frame,
                                                   const std::vector<DescribedPoint>& points,
                                                   double within_m, const SparseMap& map) const {
  std::vector<LocatedCamera> all;
  for (const KeyframeId keyframe : candidates(points, wanted, turn, map)) {
    auto place = placeAt(keyframe, frame, points, within_m, map);
    if (!place) continue;
    all.push_back(std::move(*place));
    if (turn && all.back().evidence.sum() >= kPlaceProof) break;
  }
  std::stable_sort(all.begin(), all.end(), [](const LocatedCamera& a, const LocatedCamera& b) {
    return a.evidence.sum() > b.evidence.sum();
  });
  std::vector<LocatedCamera> places;
  for (LocatedCamera& place : all) {
    const auto isSame = [&place](const LocatedCamera& better) {
      const Pose T_better_place =
          better.tracked.T_map_cam.inverse(Eigen::Isometry) * place.tracked.T_map_cam;
      return T_better_place.translation().norm() <= 1.0 && T_better_place(2, 2) >= 0.9;
    };
    if (std::none_of(places.begin(), places.end(), isSame)) places.push_back(std::move(place));
  }
  return places;
}

std::optional<LocatedCamera> LoopCloser::placeAt(KeyframeId keyframe, const TrackingFrame& frame,
                                                 const std::vector<DescribedPoint>& points,
                                                 double within_m, const SparseMap& map) const {
  const auto among = map.seenBy(map.neighbourhood(keyframe, params_.window));
  // Few matches suffice: the pose is verified by measuring patches from there.
  const auto initial = relocalise(points, among, map, camera_, params_.min_inliers / 3).T_map_cam;
  if (!initial) return std::nullopt;
  return confirmed(*initial, keyframe, among, frame, within_m, map);
}

std::optional<LocatedCamera> LoopCloser::confirmed(const Pose& T_map_cam, KeyframeId keyframe,
                                                   const std::vector<LandmarkId>& among,
                                                   const TrackingFrame& frame, double within_m,
                                                   const SparseMap& map) const {
  // What is not found in a place that is only tried says nothing of the landmarks.
  SparseMap tried = map.landmarksOnly(among);
  auto tracked = tracker_.measureLocalMap(frame, T_map_cam, among, tried, params_.min_inliers);
  if (!tracked) return std::nullopt;
  if (frame.up && !standsOnGround(tracked->T_map_cam, *frame.up, map)) return std::nullopt;
  auto evidence = evidenceOf(*tracked, among, frame, map, camera_, params_, within_m);
  return LocatedCamera{std::move(*tracked), keyframe, std::move(evidence)};
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
    const bool reachable =
        (after - T_map_cam.translation()).norm() < kDriftFloor + kMaxDrift * path;
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
  candidate.unique_within_m = isNearExpected(old, map) ? 2.0 * kNear_m : HUGE_VAL;
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
  attempt.outcome = LoopOutcome::kTooFewInliers;
  // No other place is tried, which may be as much like it.
  const auto isProven = [&] {
    return evidenceOf(*seen_from, candidate.among, frame, map, camera_, params_,
                      candidate.unique_within_m)
               .sum() >= 2 * kPlaceProof;
  };
  if (std::isinf(attempt.offset_allowed_m) && !isProven()) return std::nullopt;
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
  return kDriftFloor + kMaxDrift * path;
}

std::vector<LoopAttempt> LoopCloser::close(const TrackingFrame& frame, KeyframeId newest,
                                           SparseMap& map) const {
  std::vector<LoopAttempt> attempts;
  if (newest.value % kSpacing != 0) return attempts;
  const auto old = findLoopCandidates(newest, map);
  if (old.empty()) return attempts;
  const auto points = describe(frame);
  for (const KeyframeId keyframe : mostAlike(points, old, map)) {
    LoopCandidate candidate = candidateOf(newest, keyframe, map);
    const auto loop = verify(frame, points, candidate, map);
    attempts.push_back(candidate.attempt);
    if (!loop) continue;
    adjuster_.abandon();
    applyCorrection(posesWithLoops(keyframesOfLoop(newest, keyframe, map), {*loop}, params_.stop),
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
                                              const std::vector<KeyframeId>& among,
                                              const SparseMap& map) const {
  constexpr int kCandidates = 2;
  const auto descriptors = descriptorsOf(points);
  std::vector<KeyframeId> alike;
  const auto add = [&](bool near_expected) {
    const auto wanted = [&](KeyframeId id) {
      return std::binary_search(among.begin(), among.end(), id) &&
             isNearExpected(id, map) == near_expected;
    };
    for (const auto& match : index_.query(descriptors, kCandidates, wanted)) {
      alike.push_back(match.keyframe);
    }
  };
  if (expected_) add(true);
  add(false);
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

/// A running search. One step at a time runs in another thread, on the data in here alone.
struct LoopCloser::Search {
  enum class Step { kDescribe, kVerify, kCorrect, kAdjust };

  Step step = Step::kDescribe;
  bool abandoned = false;
  TrackingFrame frame;
  KeyframeId newest;                         ///< made of the frame
  std::vector<KeyframeId> old;               ///< keyframes that may show the same place
  std::vector<DescribedPoint> points;        ///< of the frame
  std::vector<KeyframeId> candidates;        ///< to be verified, best first
  LoopCandidate candidate;                   ///< that is being verified
  SparseMap landmarks;                       ///< copies, of its surroundings
  std::vector<LoopAttempt> attempts;         ///< candidates tested
  std::optional<ClosedLoop> loop;            ///< the verified one
  std::map<KeyframeId, Keyframe> keyframes;  ///< copies, of the whole map
  std::map<KeyframeId, Pose> corrected;
  std::future<void> running;
  WorkerThread& worker;

  explicit Search(WorkerThread& in) : worker(in) {}
  template <typename Work>
  void start(Step next, Work work) {
    step = next;
    running = worker.run(std::move(work));
  }
};

LoopCloser::LoopCloser(const StereoCamera& camera, const SlamParams& params,
                       BundleAdjuster& adjuster)
    : camera_(camera), params_(params), adjuster_(adjuster), tracker_(camera, params) {}

LoopCloser::~LoopCloser() = default;

void LoopCloser::search(const TrackingFrame& frame, KeyframeId newest, const SparseMap& map) {
  if (search_ != nullptr || newest.value % kSpacing != 0) return;
  auto old = findLoopCandidates(newest, map);
  if (old.empty()) return;
  search_ = std::make_unique<Search>(worker_);
  search_->frame = frame;
  search_->newest = newest;
  search_->old = std::move(old);
  search_->start(Search::Step::kDescribe,
                 [search = search_.get()] { search->points = describe(search->frame); });
}

std::vector<LoopAttempt> LoopCloser::closeOrSearch(const TrackingFrame& frame, KeyframeId newest,
                                                   SparseMap& map) {
  if (!params_.adjust_in_background) return close(frame, newest, map);
  search(frame, newest, map);
  return {};
}

LoopProgress LoopCloser::advance(SparseMap& map) {
  LoopProgress progress;
  if (search_ == nullptr || !isReady(search_->running)) return progress;
  search_->running.get();
  const bool in_vain = search_->abandoned || map.keyframes().count(search_->newest) == 0;
  if (in_vain && search_->step != Search::Step::kAdjust) {
    endSearch();
    return progress;
  }
  switch (search_->step) {
    case Search::Step::kDescribe:
      search_->candidates = mostAlike(search_->points, search_->old, map);
      if (!verifyNext(map)) endSearch();
      break;
    case Search::Step::kVerify:
      if (map.keyframes().count(search_->candidate.attempt.candidate) == 0) {
        search_->loop.reset();  // culled meanwhile
      } else {
        search_->attempts.push_back(search_->candidate.attempt);
      }
      if (search_->loop) {
        startCorrection(map);  // the loop is reported with the correction of the map
      } else if (!verifyNext(map)) {
        progress.attempts = std::move(search_->attempts);
        endSearch();
      }
      break;
    case Search::Step::kCorrect:
      progress.attempts = std::move(search_->attempts);
      progress.correction = correct(map);
      search_->start(Search::Step::kAdjust, [] {});
      break;
    case Search::Step::kAdjust:
      adjuster_.hold(false);
      adjustAll(*search_->loop, map);
      endSearch();
      break;
  }
  return progress;
}

LoopProgress LoopCloser::finish(SparseMap& map) {
  LoopProgress progress;
  while (search_ != nullptr) {
    search_->running.wait();
    LoopProgress step = advance(map);
    if (!step.attempts.empty() || step.correction) progress = std::move(step);
  }
  return progress;
}

void LoopCloser::abandon() {
  if (search_ != nullptr) search_->abandoned = true;
}

void LoopCloser::endSearch() {
  search_.reset();
  adjuster_.hold(false);
}

/// Starts the verification of the next candidate; false if there is none.
///
/// One at a time, because the copies of its landmarks delay the frame.
bool LoopCloser::verifyNext(const SparseMap& map) {
  while (!search_->candidates.empty()) {
    const KeyframeId old = search_->candidates.front();
    search_->candidates.erase(search_->candidates.begin());
    if (map.keyframes().count(old) == 0) continue;
    search_->candidate = candidateOf(search_->newest, old, map);
    search_->landmarks = map.landmarksOnly(search_->candidate.among);
    search_->start(Search::Step::kVerify, [this, search = search_.get()] {
      search->loop = verify(search->frame, search->points, search->candidate, search->landmarks);
    });
    return true;
  }
  return false;
}

/// The map must not be adjusted until the correction is applied.
void LoopCloser::startCorrection(const SparseMap& map) {
  adjuster_.abandon();
  adjuster_.hold(true);
  search_->keyframes = keyframesOfLoop(search_->newest, search_->candidate.attempt.candidate, map);
  search_->start(Search::Step::kCorrect, [search = search_.get(), stop = params_.stop] {
    search->corrected = posesWithLoops(search->keyframes, {*search->loop}, stop);
  });
}

/// Applies the corrected poses; the adjustment follows with the next frame. Keyframes added
/// meanwhile move with the newest one that took part.
///
/// @return  the motion of the newest keyframe
Pose LoopCloser::correct(SparseMap& map) {
  std::map<KeyframeId, Pose> poses;
  Pose correction = Pose::Identity();
  const int newest = map.submapOf(search_->newest);
  for (const auto& [id, keyframe] : map.keyframes()) {
    const auto corrected = search_->corrected.find(id);
    if (corrected != search_->corrected.end()) {
      poses[id] = corrected->second;
      correction =
          normalized(Pose(corrected->second * keyframe.T_map_cam.inverse(Eigen::Isometry)));
    } else if (keyframe.submap == newest) {
      poses[id] = normalized(Pose(correction * keyframe.T_map_cam));
    }
  }
  applyCorrection(poses, map);
  const auto old = map.keyframes().find(search_->loop->old);
  if (old != map.keyframes().end()) map.joinSubmaps(newest, old->second.submap);
  return correction;
}

}  // namespace headway::slam
