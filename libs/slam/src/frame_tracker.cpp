#include "frame_tracker.h"

#include <algorithm>

#include "consensus.h"
#include "rigid_motions.h"

namespace headway::slam {
namespace {

constexpr stereo::PoseRefinerOptions kCoarse{8.0, 4,
                                             5};  ///< from a guess that is right to some pixels
constexpr stereo::PoseRefinerOptions kFine{4.0, 3, 6};

/// Whether a landmark has agreed with the camera's motion for some frames.
bool hasProvedStill(const Landmark& landmark) {
  constexpr int kAgreed = 2;
  return landmark.agreed >= kAgreed && 2 * landmark.agreed > landmark.found;
}

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
                                               const std::vector<Pose>& guesses,
                                               const std::vector<LandmarkId>& local, bool young,
                                               SparseMap& map) const {
  const auto chosen = worthFollowing(seen_before, young, map);
  for (const Pose& guess : guesses) {
    const auto followed = tracker_.follow(previous, chosen, current, guess, map);
    const auto coarse = coarsePose(guess, followed, current, young, map);
    if (!coarse) continue;
    auto tracked = measureFrom(*coarse, current, local, map, params_.min_inliers);
    if (!tracked) continue;
    if (young && testsMotion()) tracked->dissenters = without(followed, tracked->landmarks);
    return tracked;
  }
  return std::nullopt;
}

std::optional<TrackedPose> FrameTracker::settle(const TrackingFrame& current, const Pose& T_map_cam,
                                                const std::vector<LandmarkId>& local,
                                                SparseMap& map, int min_inliers) const {
  return measureFrom({T_map_cam, {}}, current, local, map, min_inliers);
}

bool FrameTracker::testsMotion() const {
  return params_.dynamic_rejection == DynamicRejection::kGeometric ||
         params_.dynamic_rejection == DynamicRejection::kBoth;
}

bool FrameTracker::vouches(const Landmark& landmark) const {
  return !testsMotion() || hasProvedStill(landmark);
}

/// What moves is seen and mapped like everything else, but it cannot agree with the camera's
/// motion for long, so it never gets a say, however much of the image it fills.
std::vector<bool> FrameTracker::provedStill(const std::vector<TrackedLandmark>& landmarks,
                                            const SparseMap& map) const {
  std::vector<bool> proved;
  proved.reserve(landmarks.size());
  for (const TrackedLandmark& seen : landmarks) proved.push_back(vouches(*map.find(seen.id)));
  return proved;
}

/// What has proved still first, then the others, each spread evenly; all where little has proved
/// still, so that there is enough to choose the camera's motion by.
std::vector<TrackedLandmark> FrameTracker::worthFollowing(
    const std::vector<TrackedLandmark>& seen_before, bool young, const SparseMap& map) const {
  constexpr std::size_t kEnough = 160;
  std::vector<TrackedLandmark> proved, others, chosen;
  for (const TrackedLandmark& seen : seen_before) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark == nullptr) continue;
    (vouches(*landmark) ? proved : others).push_back(seen);
  }
  const bool few = proved.size() < 2 * static_cast<std::size_t>(params_.min_inliers);
  const std::size_t most = young || few ? seen_before.size() : kEnough;
  for (const auto* group : {&proved, &others}) {
    const std::size_t room = most - chosen.size();
    const std::size_t stride = 1 + group->size() / (room + 1);
    for (std::size_t i = 0; i < group->size() && chosen.size() < most; i += stride) {
      chosen.push_back((*group)[i]);
    }
  }
  return chosen;
}

std::optional<FrameTracker::CoarsePose> FrameTracker::coarsePose(
    const Pose& guess, const std::vector<TrackedLandmark>& followed, const TrackingFrame& current,
    bool young, const SparseMap& map) const {
  constexpr double kAgreement = 0.5;  ///< share of the witnesses that must agree
  if (young && testsMotion()) return stillMotion(guess, followed, current, young, map);
  const auto constraints = constraintsOf(followed, map);
  auto witnesses = only(constraints, provedStill(followed, map));
  std::optional<stereo::RefinedPose> refined;
  if (!testsMotion() || static_cast<int>(witnesses.size()) >= 2 * params_.min_inliers) {
    refined = stereo::refinePose(guess, witnesses, camera_, kCoarse);
    const int enough =
        std::max(params_.min_inliers / 2,
                 static_cast<int>(kAgreement * static_cast<double>(witnesses.size())));
    if (refined && refined->inliers >= enough) return CoarsePose{refined->T_map_cam, {}};
  }
  if (testsMotion()) return stillMotion(guess, followed, current, young, map);
  const auto consensus = poseByConsensus(constraints, camera_, params_.min_inliers / 2, 3.0);
  if (consensus) return CoarsePose{consensus->T_map_cam, {}};
  return refined ? std::optional(CoarsePose{refined->T_map_cam, {}}) : std::nullopt;
}

/// Nobody has proved still yet, or those who have do not agree: of all the motions in the image,
/// the camera's is that of what extends farthest. In a young map nobody has a name to lose: as all
/// is followed from its beginning, what moves shows ever more clearly, and the choice may change.
std::optional<FrameTracker::CoarsePose> FrameTracker::stillMotion(
    const Pose& guess, const std::vector<TrackedLandmark>& followed, const TrackingFrame& current,
    bool young, const SparseMap& map) const {
  constexpr double kAlone = 0.8;  ///< share of the landmarks that makes it the only motion
  const auto judged = withoutSuspects(followed, current);
  const auto constraints = constraintsOf(judged, map);
  const auto proved = young ? std::vector<bool>(judged.size(), false) : provedStill(judged, map);
  std::vector<Pose> likeliest{guess};
  auto all = constraints;
  if (const auto refined = stereo::refinePose(guess, all, camera_, kCoarse)) {
    likeliest.push_back(refined->T_map_cam);
  }
  const auto motions = rigidMotions(constraints, camera_, likeliest, params_.min_inliers / 2);
  const RigidMotion* best = cameraMotion(motions, constraints, proved, camera_);
  if (best == nullptr) return std::nullopt;
  CoarsePose result{best->T_map_cam, {}};
  const bool alone = best->members > kAlone * static_cast<double>(judged.size());
  if (alone && judged.size() == followed.size()) return result;  // all may have their say
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (best->agrees[i]) result.witnesses.push_back(judged[i].id);
  }
  std::sort(result.witnesses.begin(), result.witnesses.end());
  return result;
}

/// Those outside of suspect regions, where these are enough to go by.
std::vector<TrackedLandmark> FrameTracker::withoutSuspects(
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
  auto witnesses = provedStill(measured, map);
  for (std::size_t i = 0; !coarse.witnesses.empty() && i < measured.size(); ++i) {
    witnesses[i] =
        std::binary_search(coarse.witnesses.begin(), coarse.witnesses.end(), measured[i].id);
  }
  const auto refined = refineByWitnesses(coarse.T_map_cam, constraints, witnesses);
  if (!refined || refined->inliers < min_inliers) return std::nullopt;
  TrackedPose result;
  result.T_map_cam = refined->T_map_cam;
  result.covariance = refined->covariance;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!constraints[i].inlier) continue;
    ++map.find(measured[i].id)->agreed;
    result.landmarks.push_back(measured[i]);
    stereo::StereoMeasurement& measurement = result.landmarks.back().measurement;
    measurement.stereo = measurement.stereo && constraints[i].stereo_inlier;
  }
  return result;
}

/// Witnesses decide, the others may follow; without enough witnesses all decide.
std::optional<stereo::RefinedPose> FrameTracker::refineByWitnesses(
    const Pose& guess, std::vector<stereo::PoseConstraint>& constraints,
    const std::vector<bool>& is_witness) const {
  auto witnesses = only(constraints, is_witness);
  const bool enough = static_cast<int>(witnesses.size()) >= 2 * params_.min_inliers;
  if (!enough || witnesses.size() == constraints.size()) {
    return stereo::refinePose(guess, constraints, camera_, kFine);
  }
  const auto first = stereo::refinePose(guess, witnesses, camera_, kFine);
  if (!first || first->inliers < params_.min_inliers) {
    return stereo::refinePose(guess, constraints, camera_, kFine);
  }
  return refineAgreeing(first->T_map_cam, constraints, camera_, kFine.iterations);
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
