// SPDX-License-Identifier: BSD-3-Clause
// A frame's pose in the local map, from what is static in it.
#include "frame_tracker.h"

#include <algorithm>
#include <cmath>

#include "rigid_motions.h"

namespace headway::slam {
namespace {

constexpr stereo::PoseRefinerOptions kCoarse{8.0, 4, 5};  ///< from a pose within some pixels
constexpr stereo::PoseRefinerOptions kFine{4.0, 3, 6};
constexpr double kAgreement = 0.5;  ///< minimum inlier ratio of the static landmarks

/// The constraints that are chosen.
std::vector<stereo::PoseConstraint> only(const std::vector<stereo::PoseConstraint>& constraints,
                                         const std::vector<bool>& chosen) {
  std::vector<stereo::PoseConstraint> result;
  for (std::size_t i = 0; i < constraints.size(); ++i) {
    if (chosen[i]) result.push_back(constraints[i]);
  }
  return result;
}

/// Landmarks that are not among others.
std::vector<TrackedLandmark> without(const std::vector<TrackedLandmark>& landmarks,
                                     const std::vector<TrackedLandmark>& others) {
  std::vector<LandmarkId> ids;
  for (const TrackedLandmark& other : others) ids.push_back(other.id);
  std::sort(ids.begin(), ids.end());
  std::vector<TrackedLandmark> result;
  for (const TrackedLandmark& landmark : landmarks) {
    if (!std::binary_search(ids.begin(), ids.end(), landmark.id)) result.push_back(landmark);
  }
  return result;
}

/// Refines a pose with the constraints that agree with it; the others become outliers.
std::optional<stereo::RefinedPose> refineAgreeing(const Pose& T_map_cam,
                                                  std::vector<stereo::PoseConstraint>& constraints,
                                                  const StereoCamera& camera, int iterations) {
  constexpr double kGateScale = 2.0;
  stereo::markInliers(T_map_cam, constraints, camera, kGateScale);
  std::vector<stereo::PoseConstraint> agreeing;
  for (const stereo::PoseConstraint& constraint : constraints) {
    if (constraint.inlier) agreeing.push_back(constraint);
  }
  const auto refined = stereo::refinePose(T_map_cam, agreeing, camera, {1.0, 2, iterations});
  auto next = agreeing.begin();
  for (stereo::PoseConstraint& constraint : constraints) {
    if (constraint.inlier) constraint = *next++;
  }
  return refined;
}

}  // namespace

std::optional<TrackedPose> FrameTracker::track(const TrackingFrame& previous,
                                               const std::vector<TrackedLandmark>& seen_before,
                                               const TrackingFrame& current,
                                               const std::optional<Pose>& proposed,
                                               const std::vector<Pose>& initial_poses,
                                               const std::vector<LandmarkId>& local, bool new_map,
                                               SparseMap& map) const {
  if (proposed && !new_map) {
    auto tracked = measureLocalMap(current, *proposed, local, map, params_.min_inliers);
    if (tracked && findsStatic(*tracked, seen_before, current, map)) return tracked;
  }
  const auto chosen = selectLandmarksToFollow(seen_before, new_map, map);
  for (const Pose& predicted : initial_poses) {
    const auto followed = tracker_.follow(previous, chosen, current, predicted, map);
    const auto coarse = coarsePose(predicted, followed, current, new_map, map);
    if (!coarse) continue;
    auto tracked = measureFrom(*coarse, current, local, map, params_.min_inliers);
    if (!tracked) continue;
    if (new_map && rejectsByGeometry())
      tracked->dynamic_outliers = without(followed, tracked->landmarks);
    return tracked;
  }
  return std::nullopt;
}

std::optional<TrackedPose> FrameTracker::measureLocalMap(const TrackingFrame& current,
                                                         const Pose& T_map_cam,
                                                         const std::vector<LandmarkId>& local,
                                                         SparseMap& map, int min_inliers) const {
  return measureFrom({T_map_cam, {}}, current, local, map, min_inliers);
}

bool FrameTracker::findsStatic(const TrackedPose& tracked,
                               const std::vector<TrackedLandmark>& seen_before,
                               const TrackingFrame& current, const SparseMap& map) const {
  std::vector<LandmarkId> found;
  for (const TrackedLandmark& landmark : tracked.landmarks) found.push_back(landmark.id);
  std::sort(found.begin(), found.end());
  const Pose T_cam_map = tracked.T_map_cam.inverse(Eigen::Isometry);
  int expected = 0;
  int agreeing = 0;
  for (const TrackedLandmark& seen : seen_before) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark == nullptr || !isStatic(*landmark)) continue;
    if (!visibleAt(T_cam_map * landmark->position, current, camera_)) continue;
    ++expected;
    agreeing += std::binary_search(found.begin(), found.end(), seen.id) ? 1 : 0;
  }
  return expected >= 2 * params_.min_inliers && agreeing >= kAgreement * expected;
}

std::optional<Pose> FrameTracker::poseOf(const std::vector<TrackedLandmark>& seen,
                                         const Pose& initial, const SparseMap& map) const {
  std::vector<TrackedLandmark> known;
  for (const TrackedLandmark& landmark : seen) {
    if (map.find(landmark.id) != nullptr) known.push_back(landmark);
  }
  auto constraints = constraintsOf(known, map);
  const auto refined = stereo::refinePose(initial, constraints, camera_, kFine);
  if (!refined || refined->inliers < params_.min_inliers) return std::nullopt;
  return refined->T_map_cam;
}

void FrameTracker::setInterval(double interval_s) {
  constexpr double kVerified_s = 0.2;  ///< a walking person moves 0.3 m in it
  frames_to_verify_ = std::max(
      kMinFramesToVerify, static_cast<int>(std::lround(std::min(kVerified_s / interval_s, 100.0))));
}

bool FrameTracker::rejectsByGeometry() const {
  return params_.dynamic_rejection == DynamicRejection::kGeometric ||
         params_.dynamic_rejection == DynamicRejection::kBoth;
}

bool FrameTracker::isStatic(const Landmark& landmark) const {
  const bool is_verified =
      landmark.agreed >= frames_to_verify_ && 2 * landmark.agreed > landmark.found;
  return is_verified || !rejectsByGeometry();
}

/// Moving objects are mapped like everything else, but cannot agree with the camera's motion for
/// long, so they are never verified, however much of the image they cover.
std::vector<bool> FrameTracker::staticMask(const std::vector<TrackedLandmark>& landmarks,
                                           const SparseMap& map) const {
  std::vector<bool> verified;
  verified.reserve(landmarks.size());
  for (const TrackedLandmark& seen : landmarks) verified.push_back(isStatic(*map.find(seen.id)));
  return verified;
}

std::vector<TrackedLandmark> FrameTracker::selectLandmarksToFollow(
    const std::vector<TrackedLandmark>& seen_before, bool new_map, const SparseMap& map) const {
  constexpr std::size_t kEnough = 160;
  std::vector<TrackedLandmark> verified, others, chosen;
  for (const TrackedLandmark& seen : seen_before) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark == nullptr) continue;
    (isStatic(*landmark) ? verified : others).push_back(seen);
  }
  const bool few = verified.size() < 2 * static_cast<std::size_t>(params_.min_inliers);
  const std::size_t max = new_map || few ? seen_before.size() : kEnough;
  for (const auto* group : {&verified, &others}) {
    const std::size_t count = std::min(group->size(), max - chosen.size());
    for (std::size_t i = 0; i < count; ++i) chosen.push_back((*group)[i * group->size() / count]);
  }
  return chosen;
}

std::optional<FrameTracker::CoarsePose> FrameTracker::coarsePose(
    const Pose& predicted, const std::vector<TrackedLandmark>& followed,
    const TrackingFrame& current, bool new_map, const SparseMap& map) const {
  if (new_map && rejectsByGeometry())
    return coarsePoseByRigidMotions(predicted, followed, current, new_map, map);
  const auto constraints = constraintsOf(followed, map);
  auto static_inliers = only(constraints, staticMask(followed, map));
  std::optional<stereo::RefinedPose> refined;
  if (!rejectsByGeometry() || static_cast<int>(static_inliers.size()) >= 2 * params_.min_inliers) {
    refined = stereo::refinePose(predicted, static_inliers, camera_, kCoarse);
    const int enough =
        std::max(params_.min_inliers / 2,
                 static_cast<int>(kAgreement * static_cast<double>(static_inliers.size())));
    if (refined && refined->inliers >= enough) return CoarsePose{refined->T_map_cam, {}};
  }
  if (rejectsByGeometry())
    return coarsePoseByRigidMotions(predicted, followed, current, new_map, map);
  const auto consensus = poseByConsensus(constraints, camera_, params_.min_inliers / 2, 3.0);
  if (consensus) return CoarsePose{consensus->T_map_cam, {}};
  return refined ? std::optional(CoarsePose{refined->T_map_cam, {}}) : std::nullopt;
}

/// Used where no landmark is verified static yet or the verified ones disagree: of all rigid
/// motions in the image, the camera's is the one with the largest extent. A new map has no verified
/// landmarks, so the choice is made anew in each of its frames.
std::optional<FrameTracker::CoarsePose> FrameTracker::coarsePoseByRigidMotions(
    const Pose& predicted, const std::vector<TrackedLandmark>& followed,
    const TrackingFrame& current, bool new_map, const SparseMap& map) const {
  constexpr double kAlone = 0.8;  ///< minimum ratio of the landmarks for the only motion
  const auto candidates = outsideSuspectRegions(followed, current);
  const auto constraints = constraintsOf(candidates, map);
  const auto verified =
      new_map ? std::vector<bool>(candidates.size(), false) : staticMask(candidates, map);
  std::vector<Pose> initial_poses{predicted};
  auto all = constraints;
  if (const auto refined = stereo::refinePose(predicted, all, camera_, kCoarse)) {
    initial_poses.push_back(refined->T_map_cam);
  }
  const auto motions = rigidMotions(constraints, camera_, initial_poses, params_.min_inliers / 2);
  const RigidMotion* best = cameraMotion(motions, constraints, verified, camera_);
  if (best == nullptr) return std::nullopt;
  CoarsePose result{best->T_map_cam, {}};
  const bool alone = best->members > kAlone * static_cast<double>(candidates.size());
  if (alone && candidates.size() == followed.size())
    return result;  // one motion: all landmarks may constrain the pose
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (best->agrees[i]) result.static_inliers.push_back(candidates[i].id);
  }
  std::sort(result.static_inliers.begin(), result.static_inliers.end());
  return result;
}

/// Landmarks outside of suspect regions, or all where too few are outside.
std::vector<TrackedLandmark> FrameTracker::outsideSuspectRegions(
    const std::vector<TrackedLandmark>& followed, const TrackingFrame& current) const {
  std::vector<TrackedLandmark> others;
  for (const TrackedLandmark& seen : followed) {
    if (!isExcluded(current.suspect, seen.measurement.uv)) others.push_back(seen);
  }
  return static_cast<int>(others.size()) >= 2 * params_.min_inliers ? others : followed;
}

std::optional<TrackedPose> FrameTracker::measureFrom(const CoarsePose& coarse,
                                                     const TrackingFrame& current,
                                                     const std::vector<LandmarkId>& local,
                                                     SparseMap& map, int min_inliers) const {
  const auto measured = tracker_.measure(current, coarse.T_map_cam, local, map);
  auto constraints = constraintsOf(measured, map);
  auto static_inliers = staticMask(measured, map);
  for (std::size_t i = 0; !coarse.static_inliers.empty() && i < measured.size(); ++i) {
    static_inliers[i] = std::binary_search(coarse.static_inliers.begin(),
                                           coarse.static_inliers.end(), measured[i].id);
  }
  const auto refined = refineByStaticInliers(coarse.T_map_cam, constraints, static_inliers);
  if (!refined || refined->inliers < min_inliers) return std::nullopt;
  TrackedPose result;
  result.T_map_cam = refined->T_map_cam;
  result.covariance = refined->covariance;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!constraints[i].inlier) continue;
    ++map.findToChange(measured[i].id)->agreed;
    result.landmarks.push_back(measured[i]);
    stereo::StereoMeasurement& measurement = result.landmarks.back().measurement;
    measurement.stereo = measurement.stereo && constraints[i].stereo_inlier;
  }
  return result;
}

/// The static inliers determine the pose and the others are added where they agree; with too few
/// static inliers, all landmarks determine it.
std::optional<stereo::RefinedPose> FrameTracker::refineByStaticInliers(
    const Pose& predicted, std::vector<stereo::PoseConstraint>& constraints,
    const std::vector<bool>& is_static) const {
  auto static_inliers = only(constraints, is_static);
  const bool enough = static_cast<int>(static_inliers.size()) >= 2 * params_.min_inliers;
  if (!enough || static_inliers.size() == constraints.size()) {
    return stereo::refinePose(predicted, constraints, camera_, kFine);
  }
  const auto first = stereo::refinePose(predicted, static_inliers, camera_, kFine);
  if (!first || first->inliers < params_.min_inliers) {
    return stereo::refinePose(predicted, constraints, camera_, kFine);
  }
  const Pose pose = rejectsByGeometry() ? poseOfOneMotion(first->T_map_cam, static_inliers, camera_)
                                        : first->T_map_cam;
  return refineAgreeing(pose, constraints, camera_, kFine.iterations);
}

std::vector<stereo::PoseConstraint> FrameTracker::constraintsOf(
    const std::vector<TrackedLandmark>& landmarks, const SparseMap& map) const {
  std::vector<stereo::PoseConstraint> constraints;
  constraints.reserve(landmarks.size());
  for (const TrackedLandmark& seen : landmarks) {
    constraints.push_back(
        {map.find(seen.id)->position, map.corrected(seen.measurement), true, true});
  }
  return constraints;
}

}  // namespace headway::slam
