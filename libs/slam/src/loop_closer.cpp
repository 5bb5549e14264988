#include "loop_closer.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <set>

#include "relocaliser.h"

namespace headway::slam {
namespace {

constexpr int kCorners = 1000;       ///< of a frame that is to be recognised
constexpr int kMinAge = 20;          ///< keyframes between a place and its return, at least
constexpr int kSpacing = 3;          ///< keyframes between two searches for a loop
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

/// Keyframes that no chain of shared landmarks connects to the newest one, so that their distance
/// is unknown, ascending.
std::vector<KeyframeId> unrelatedTo(KeyframeId newest, const SparseMap& map) {
  const auto& keyframes = map.keyframes();
  const auto apart = [](const auto& a, const auto& b) {
    return shareNoLandmarks(a.second, b.second);
  };
  if (std::adjacent_find(keyframes.begin(), keyframes.end(), apart) == keyframes.end()) return {};
  std::set<KeyframeId> related{newest};
  std::vector<KeyframeId> open{newest};
  while (!open.empty()) {
    const Keyframe& keyframe = map.keyframe(open.back());
    open.pop_back();
    for (const LandmarkId id : keyframe.landmarks) {
      for (const LandmarkObservation& observation : map.find(id)->observations) {
        if (related.insert(observation.keyframe).second) open.push_back(observation.keyframe);
      }
    }
  }
  std::vector<KeyframeId> unrelated;
  for (const auto& [id, keyframe] : keyframes) {
    if (related.count(id) == 0) unrelated.push_back(id);
  }
  return unrelated;
}

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

/// Constrains a submap that shares no landmarks with the rest; any other edge outweighs it.
PoseGraphEdge weakEdgeBetween(const Keyframe& a, const Keyframe& b) {
  PoseGraphEdge edge = edgeBetween(a, b);
  edge.sigma_m = 100.0;
  edge.sigma_rad = 10.0;
  return edge;
}

}  // namespace

std::vector<PoseGraphEdge> edgesOf(const SparseMap& map) {
  constexpr int kNeighbours = 5;
  std::vector<PoseGraphEdge> edges;
  const Keyframe* before = nullptr;
  for (const auto& [id, keyframe] : map.keyframes()) {
    if (before != nullptr) {
      edges.push_back(shareNoLandmarks(*before, keyframe) ? weakEdgeBetween(*before, keyframe)
                                                          : edgeBetween(*before, keyframe));
    }
    for (const KeyframeId other : map.neighbourhood(id, kNeighbours)) {
      if (other < id && (before == nullptr || other != before->id)) {
        edges.push_back(edgeBetween(map.keyframe(other), keyframe));
      }
    }
    before = &keyframe;
  }
  return edges;
}

void applyCorrection(const std::map<KeyframeId, Pose>& corrected, SparseMap& map) {
  for (const auto& [id, landmark] : map.landmarks()) {
    const Pose& before = map.keyframe(landmark.reference).T_map_cam;
    map.find(id)->position =
        corrected.at(landmark.reference) * (before.inverse(Eigen::Isometry) * landmark.position);
  }
  for (const auto& [id, pose] : corrected) map.keyframe(id).T_map_cam = pose;
}

void LoopCloser::index(KeyframeId keyframe, const SparseMap& map) {
  index_.add(keyframe, descriptorsOf(keyframe, map));
}

std::optional<TrackedPose> LoopCloser::locate(const TrackingFrame& frame, SparseMap& map,
                                              KeyframeId* keyframe) const {
  constexpr int kCandidates = 5;
  const auto points = detectAndDescribe(frame.left.levels.front(), kCorners, frame.excluded);
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

std::optional<TrackedPose> LoopCloser::verify(const TrackingFrame& frame,
                                              const std::vector<DescribedPoint>& points,
                                              LoopAttempt& attempt, SparseMap& map) const {
  const auto among = map.seenBy(map.neighbourhood(attempt.candidate, params_.window));
  const auto recognised = relocalise(points, among, map, camera_, params_.min_inliers);
  attempt.outcome = LoopOutcome::kNotRecognised;
  attempt.inliers = recognised.inliers;
  attempt.inliers_needed = params_.min_inliers;
  if (!recognised.T_map_cam) return std::nullopt;
  auto seen_from = tracker_.measureLocalMap(frame, *recognised.T_map_cam, among, map, 0);
  attempt.outcome = LoopOutcome::kTooFewInliers;
  attempt.inliers = seen_from ? static_cast<int>(seen_from->landmarks.size()) : 0;
  attempt.inliers_needed = 3 * params_.min_inliers;
  if (attempt.inliers < attempt.inliers_needed) return std::nullopt;
  measureOffset(*seen_from, map, attempt);
  attempt.outcome =
      attempt.offset_m > attempt.offset_allowed_m ? LoopOutcome::kTooFarOff : LoopOutcome::kClosed;
  return attempt.outcome == LoopOutcome::kClosed ? seen_from : std::nullopt;
}

/// How far the new keyframe is from where the old one sees it, and how far drift may have taken it.
void LoopCloser::measureOffset(const TrackedPose& seen_from, const SparseMap& map,
                               LoopAttempt& attempt) const {
  const Eigen::Vector3d& before = map.keyframe(attempt.keyframe).T_map_cam.translation();
  attempt.offset_m = (seen_from.T_map_cam.translation() - before).norm();
  const auto anywhere = unrelatedTo(attempt.keyframe, map);
  if (std::binary_search(anywhere.begin(), anywhere.end(), attempt.candidate)) {
    attempt.offset_allowed_m = std::numeric_limits<double>::infinity();
    return;
  }
  double path = 0.0;
  Eigen::Vector3d last = map.keyframe(attempt.candidate).T_map_cam.translation();
  for (auto at = map.keyframes().find(attempt.candidate); at != map.keyframes().end(); ++at) {
    path += (at->second.T_map_cam.translation() - last).norm();
    last = at->second.T_map_cam.translation();
  }
  attempt.offset_allowed_m = kDriftFloor + kDrift * path;
}

std::vector<LoopAttempt> LoopCloser::close(const TrackingFrame& frame, KeyframeId newest,
                                           SparseMap& map) const {
  constexpr int kCandidates = 2;
  std::vector<LoopAttempt> attempts;
  if (newest.value % kSpacing != 0) return attempts;
  const auto old = findLoopCandidates(newest, map);
  if (old.empty()) return attempts;
  const auto points = detectAndDescribe(frame.left.levels.front(), kCorners, frame.excluded);
  const auto wanted = [&](KeyframeId id) { return std::binary_search(old.begin(), old.end(), id); };
  for (const auto& match : index_.query(descriptorsOf(points), kCandidates, wanted)) {
    LoopAttempt attempt;
    attempt.keyframe = newest;
    attempt.candidate = match.keyframe;
    const auto seen_from = verify(frame, points, attempt, map);
    attempts.push_back(attempt);
    if (!seen_from) continue;
    correct(newest, match.keyframe, *seen_from, map);
    break;
  }
  return attempts;
}

void LoopCloser::correct(KeyframeId newest, KeyframeId old, const TrackedPose& seen_from,
                         SparseMap& map) const {
  constexpr int kGlobalIterations = 8;
  adjuster_.abandon();
  auto edges = edgesOf(map);
  PoseGraphEdge loop = edgeBetween(map.keyframe(old), map.keyframe(newest));
  loop.T_a_b = map.keyframe(old).T_map_cam.inverse(Eigen::Isometry) * seen_from.T_map_cam;
  edges.push_back(loop);
  std::map<KeyframeId, Pose> poses;
  for (const auto& [id, keyframe] : map.keyframes()) poses[id] = keyframe.T_map_cam;
  applyCorrection(optimisePoseGraph(poses, edges), map);
  const auto& seen = map.keyframe(newest).landmarks;
  for (const TrackedLandmark& landmark : seen_from.landmarks) {
    if (std::binary_search(seen.begin(), seen.end(), landmark.id)) continue;
    map.observe(newest, landmark.id, landmark.measurement);
  }
  std::vector<KeyframeId> all;
  for (const auto& [id, keyframe] : map.keyframes()) all.push_back(id);
  adjuster_.adjust(map, all, kGlobalIterations);
}

}  // namespace headway::slam
