#include "frame_tracker.h"

#include <opencv2/calib3d.hpp>

namespace headway::slam {
namespace {

/// Whether a landmark has agreed with the camera's motion for some frames.
bool isSenior(const Landmark& landmark) {
  constexpr int kAgreed = 2;
  return landmark.agreed >= kAgreed && 2 * landmark.agreed > landmark.found;
}

/// Refines a pose with the constraints that agree with it; the others become outliers.
std::optional<RefinedPose> refineAgreeing(const Pose& T_map_cam,
                                          std::vector<PoseConstraint>& constraints,
                                          const StereoCamera& camera, int iterations) {
  constexpr double kGateScale = 2.0;
  markInliers(T_map_cam, constraints, camera, kGateScale);
  std::vector<PoseConstraint> agreeing;
  for (const PoseConstraint& constraint : constraints) {
    if (constraint.inlier) agreeing.push_back(constraint);
  }
  const auto refined = refinePose(T_map_cam, agreeing, camera, {1.0, 2, iterations});
  auto next = agreeing.begin();
  for (PoseConstraint& constraint : constraints) {
    if (constraint.inlier) constraint = *next++;
  }
  return refined;
}

}  // namespace

std::optional<TrackedPose> FrameTracker::track(const TrackingFrame& previous,
                                               const std::vector<TrackedLandmark>& seen_before,
                                               const TrackingFrame& current,
                                               const std::vector<Pose>& guesses,
                                               const std::vector<LandmarkId>& local,
                                               SparseMap& map) const {
  for (const Pose& guess : guesses) {
    const auto followed = tracker_.follow(previous, seen_before, current, guess, map);
    const auto coarse = poseFromFollowed(guess, followed, map);
    if (!coarse) continue;
    auto tracked = settle(current, *coarse, local, map);
    if (tracked) return tracked;
  }
  return std::nullopt;
}

std::optional<Pose> FrameTracker::poseFromFollowed(const Pose& guess,
                                                   const std::vector<TrackedLandmark>& followed,
                                                   const SparseMap& map) const {
  constexpr double kAgreement = 0.5;  ///< share of the followed landmarks that must agree
  auto constraints = constraintsOf(followed, map);
  const int enough = std::max(params_.min_inliers / 2,
                              static_cast<int>(kAgreement * static_cast<double>(followed.size())));
  const auto refined = refineBySeniority(guess, followed, constraints, {8.0, 4, 5}, map);
  if (refined && refined->inliers >= enough) return refined->T_map_cam;
  const auto consensus = poseByConsensus(constraints, camera_, params_.min_inliers / 2, 3.0);
  if (!consensus) return refined ? std::optional(refined->T_map_cam) : std::nullopt;
  return consensus;
}

std::optional<TrackedPose> FrameTracker::settle(const TrackingFrame& current, const Pose& T_map_cam,
                                                const std::vector<LandmarkId>& local,
                                                SparseMap& map) const {
  const auto measured = tracker_.measure(current, T_map_cam, local, map);
  auto constraints = constraintsOf(measured, map);
  const auto refined = refineBySeniority(T_map_cam, measured, constraints, {4.0, 3, 6}, map);
  if (!refined || refined->inliers < params_.min_inliers) return std::nullopt;
  TrackedPose result;
  result.T_map_cam = refined->T_map_cam;
  result.covariance = refined->covariance;
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (!constraints[i].inlier) continue;
    ++map.find(measured[i].id)->agreed;
    result.landmarks.push_back(measured[i]);
    StereoMeasurement& measurement = result.landmarks.back().measurement;
    measurement.stereo = measurement.stereo && constraints[i].stereo_inlier;
  }
  return result;
}

/// With the geometric test, landmarks that have proved still decide; the others may follow.
///
/// What moves is seen and mapped like everything else, but it cannot agree with the camera's
/// motion for long, so it never gets a say, however much of the image it fills.
std::optional<RefinedPose> FrameTracker::refineBySeniority(
    const Pose& guess, const std::vector<TrackedLandmark>& landmarks,
    std::vector<PoseConstraint>& constraints, const PoseRefinerOptions& options,
    const SparseMap& map) const {
  const bool wanted = params_.dynamic_rejection == DynamicRejection::kGeometric ||
                      params_.dynamic_rejection == DynamicRejection::kBoth;
  std::vector<PoseConstraint> seniors;
  for (std::size_t i = 0; wanted && i < landmarks.size(); ++i) {
    if (isSenior(*map.find(landmarks[i].id))) seniors.push_back(constraints[i]);
  }
  if (static_cast<int>(seniors.size()) < 2 * params_.min_inliers) {
    return refinePose(guess, constraints, camera_, options);
  }
  const auto first = refinePose(guess, seniors, camera_, options);
  if (!first || first->inliers < params_.min_inliers) {
    return refinePose(guess, constraints, camera_, options);
  }
  return refineAgreeing(first->T_map_cam, constraints, camera_, options.iterations);
}

std::vector<PoseConstraint> FrameTracker::constraintsOf(
    const std::vector<TrackedLandmark>& landmarks, const SparseMap& map) const {
  std::vector<PoseConstraint> constraints;
  constraints.reserve(landmarks.size());
  for (const TrackedLandmark& seen : landmarks) {
    constraints.push_back(
        {map.find(seen.id)->position, map.corrected(seen.measurement), true, true});
  }
  return constraints;
}

std::optional<Pose> poseByConsensus(const std::vector<PoseConstraint>& constraints,
                                    const StereoCamera& camera, int min_inliers,
                                    double max_error_px) {
  constexpr int kIterations = 200;
  constexpr double kConfidence = 0.999;
  if (static_cast<int>(constraints.size()) < std::max(6, min_inliers)) return std::nullopt;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const PoseConstraint& constraint : constraints) {
    const Eigen::Vector3d& p = constraint.point_map;
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.emplace_back(constraint.measurement.uv.x(), constraint.measurement.uv.y());
  }
  const cv::Matx33d intrinsics(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Vec3d rotation, translation;
  std::vector<int> inliers;
  const bool found = cv::solvePnPRansac(
      points, pixels, intrinsics, cv::noArray(), rotation, translation, false, kIterations,
      static_cast<float>(max_error_px), kConfidence, inliers, cv::SOLVEPNP_P3P);
  if (!found || static_cast<int>(inliers.size()) < min_inliers) return std::nullopt;
  Pose T_cam_map = Pose::Identity();
  T_cam_map.linear() = expSo3({rotation[0], rotation[1], rotation[2]});
  T_cam_map.translation() << translation[0], translation[1], translation[2];
  if (!T_cam_map.matrix().allFinite()) return std::nullopt;
  return T_cam_map.inverse(Eigen::Isometry);
}

}  // namespace headway::slam
