// SPDX-License-Identifier: BSD-3-Clause
#include <headway/slam/stereo_slam.h>

#include "map_culling.h"
#include "pose_covariance.h"
#include "reference_choice.h"
#include "stereo_slam_implementation.h"

namespace headway::slam {

SlamUpdate StereoSlam::Implementation::process(const stereo::FrameContext& context,
                                               const MovingRegions& moving, ImageEvidence images) {
  LoopProgress searched = takeBackgroundWork();
  const StereoFrame& frame = context.frame();
  const bool is_repeated = images == ImageEvidence::kSeenBefore;
  const bool stands = standstill_check_.add(frame.time, frame.motion_prior, !is_repeated);
  const bool is_frozen = is_repeated && !(params_.use_odometry && stands);
  TrackingFrame current;
  std::optional<TrackedPose> tracked;
  {
    const auto watch = times_.watch("slam_track");
    mapper_.addOdometry(frame.motion_prior);
    odometry_since_tracked_.add(frame.motion_prior);
    current = makeTrackingFrame(context, moving, *camera_, params_);
    if (!is_frozen) tracked = track(context, current);
  }
  const auto watch = times_.watch("slam_map");
  SlamUpdate update = is_frozen ? passOver(frame) : localised(frame, current, tracked, images);
  update.imu = inertial_.status();
  update.map_corrected = searched.correction.has_value();
  if (!searched.attempts.empty()) update.loops = std::move(searched.attempts);
  update.T_map_robot = normalized(motion_.last() * T_cam_robot_);
  update.covariance = composedCovariance(covariance_, T_cam_robot_, PoseCovariance::Zero());
  const bool is_tracked = update.status == TrackingStatus::kTracked;
  trajectory_.add(current.index, current.time, is_tracked, motion_.last(), reference_, map_);
  if (update.status == TrackingStatus::kLost || is_frozen) return update;
  odometry_since_tracked_.restartAt(*reference_);
  covariance_when_tracked_ = covariance_;
  previous_ = std::move(current);
  return update;
}

/// Takes the pose that was tracked, if one was, and all that sets the motion before against it.
SlamUpdate StereoSlam::Implementation::localised(const StereoFrame& frame,
                                                 const TrackingFrame& current,
                                                 std::optional<TrackedPose>& tracked,
                                                 ImageEvidence images) {
  const Stamped<Pose> previous{previous_.time, motion_.last()};
  const bool tracked_twice = tracked && !relocalised_ && lost_in_a_row_ == 0;
  const Pose T_map_cam = tracked ? tracked->T_map_cam : Pose::Identity();
  const double sigma_m = tracked ? positionSigma(tracked->covariance) : 0.0;
  SlamUpdate update = tracked ? accept(current, *tracked) : handleLost(frame, current);
  if (tracked_twice) {
    const Pose T_previous_current = previous.value.inverse(Eigen::Isometry) * T_map_cam;
    const MeasuredStep step{frame.time, camera_->T_robot_cam * T_previous_current * T_cam_robot_,
                            sigma_m, rotationSigma(tracked->covariance)};
    update.doubt = doubtOf(step, frame.time - previous.time, frame.motion_prior);
    levelMap(frame, previous, T_map_cam, std::hypot(sigma_m, previous_sigma_m_));
  } else {
    odometry_check_.restart();
    inertial_.interrupt();
  }
  previous_sigma_m_ = sigma_m;
  if (update.status != TrackingStatus::kTracked) return update;
  if (images == ImageEvidence::kContradictory) update.doubt = Doubt::kImages;
  if (update.doubt != Doubt::kNone) update.status = TrackingStatus::kUnreliable;
  return update;
}

/// What contradicts a motion that was measured.
Doubt StereoSlam::Implementation::doubtOf(const MeasuredStep& step, double seconds,
                                          const MotionPrior& prior) {
  const bool agrees = !params_.use_odometry || odometry_check_.add(step, prior);
  const double metres = step.T_previous_current.translation().norm();
  if (seconds > 0.0 && metres > params_.max_speed_mps * seconds) return Doubt::kSpeed;
  return agrees ? Doubt::kNone : Doubt::kOdometry;
}

/// Tracks from the last pose, or else relocalises in the whole map.
std::optional<TrackedPose> StereoSlam::Implementation::track(const stereo::FrameContext& context,
                                                             const TrackingFrame& current) {
  relocalised_ = false;
  if (!reference_) {
    initialiseMotion(context);
    if (map_.keyframes().empty()) return std::nullopt;
  }
  const std::vector<Pose> initial_poses{motion_.predict(context.frame()), motion_.last()};
  auto tracked = tracker_.track(previous_, seen_before_, current, initial_poses, local_landmarks_,
                                active_submap_.isNew(), map_);
  if (tracked) return tracked;
  KeyframeId recognised;
  tracked = loops_.locate(current, map_, &recognised);
  if (!tracked) return std::nullopt;
  relocalised_ = true;
  setReferenceKeyframe(recognised);
  active_submap_.relocaliseAt(recognised);
  return tracked;
}

/// The robot's first pose: upright as it is mounted, or as gravity tells where it is not.
void StereoSlam::Implementation::initialiseMotion(const stereo::FrameContext& context) {
  const StereoFrame& frame = context.frame();
  if (!params_.use_imu) return motion_.initialise(frame.time, Eigen::Vector3d::UnitZ());
  const auto up_ground = [&]() -> std::optional<Eigen::Vector3d> {
    if (!context.ground()) return std::nullopt;
    return Eigen::Vector3d(camera_->T_robot_cam.linear() * context.ground()->up);
  };
  motion_.initialise(frame.time, inertial_.initialUp(frame.motion_prior, up_ground));
}

/// Turns the map about its origin where gravity shows that it is not level.
///
/// @param sigma_m  of the camera's motion between both frames
void StereoSlam::Implementation::levelMap(const StereoFrame& frame, const Stamped<Pose>& previous,
                                          const Pose& T_map_cam, double sigma_m) {
  if (!params_.use_imu) return;
  const Pose T_previous_current = previous.value.inverse(Eigen::Isometry) * T_map_cam;
  const CameraStep step{frame.time - previous.time, previous.value * T_cam_robot_,
                        camera_->T_robot_cam * T_previous_current * T_cam_robot_, sigma_m};
  const auto rotation = inertial_.add(step, frame.motion_prior);
  if (inertial_.isLeftOut()) motion_.disableImu();
  if (!rotation || !params_.mapping) return;
  const Pose turn(*rotation);
  adjuster_.abandon();
  loops_.abandon();
  std::map<KeyframeId, Pose> poses;
  for (const auto& [id, key] : map_.keyframes()) poses[id] = normalized(turn * key.T_map_cam);
  applyCorrection(poses, map_);
  motion_.correct(normalized(turn * motion_.last()));
}

/// The camera is tracked: choose its reference keyframe or insert a new one.
SlamUpdate StereoSlam::Implementation::accept(const TrackingFrame& current, TrackedPose& tracked) {
  SlamUpdate update;
  update.status = TrackingStatus::kTracked;
  update.inliers = static_cast<int>(tracked.landmarks.size());
  const Keyframe& reference = map_.keyframe(*reference_);
  const Pose T_reference_cam = reference.T_map_cam.inverse(Eigen::Isometry) * tracked.T_map_cam;
  covariance_ = composedCovariance(reference.covariance, T_reference_cam, tracked.covariance);
  if (lost_in_a_row_ > 0) {
    motion_.reset(current.time, tracked.T_map_cam);  // predicted to measured pose is no velocity
  } else {
    motion_.update(current.time, tracked.T_map_cam);
  }
  lost_in_a_row_ = 0;
  active_submap_.countTrackedFrame();
  const auto chosen = referenceOf(tracked.landmarks, *reference_, params_, camera_->width, map_);
  if (!chosen) {
    makeKeyframe(current, tracked, update);
  } else if (*chosen != *reference_) {
    setReferenceKeyframe(*chosen);
  }
  seen_before_ = std::move(tracked.landmarks);
  update.features = static_cast<int>(seen_before_.size());
  seen_before_.insert(seen_before_.end(), tracked.dynamic_outliers.begin(),
                      tracked.dynamic_outliers.end());
  return update;
}

/// Inserts the frame as a keyframe, closes loops, and removes redundant keyframes.
void StereoSlam::Implementation::makeKeyframe(const TrackingFrame& current, TrackedPose& tracked,
                                              SlamUpdate& update) {
  update.is_keyframe = true;
  const KeyframeId id =
      mapper_.insert(current, tracked.T_map_cam, covariance_, tracked.landmarks, map_);
  loops_.index(id, map_);
  if (params_.loop_closing) update.loops = loops_.closeOrSearch(current, id, map_);
  motion_.correct(map_.keyframe(id).T_map_cam);
  while (const auto redundant = redundantKeyframe(id, params_.window, map_)) {
    remove(*redundant, replacementKeyframe(*redundant, map_));
  }
  setReferenceKeyframe(id);
}

/// Sets the keyframe whose neighbourhood the next frames are tracked against.
void StereoSlam::Implementation::setReferenceKeyframe(KeyframeId keyframe) {
  reference_ = keyframe;
  local_landmarks_ = map_.seenBy(map_.neighbourhood(keyframe, params_.window));
}

/// Removes an abandoned submap, the keyframes from `first` up to `end`, its replacement.
void StereoSlam::Implementation::removeSubmap(KeyframeId first, KeyframeId end) {
  auto at = map_.keyframes().lower_bound(first);
  while (at != map_.keyframes().end() && at->first < end) remove((at++)->first, end);
}

/// Removes a keyframe; the frames anchored to it are reassigned to another.
void StereoSlam::Implementation::remove(KeyframeId keyframe, KeyframeId replacement) {
  trajectory_.reassign(keyframe, replacement, map_);
  loops_.remove(keyframe);
  map_.removeKeyframe(keyframe);
}

/// Applies what finished in the background.
LoopProgress StereoSlam::Implementation::takeBackgroundWork() {
  const auto watch = times_.watch("slam_background");
  applyCorrectionToMotion(adjuster_.applyFinished(map_));
  LoopProgress searched = loops_.advance(map_);
  applyCorrectionToMotion(searched.correction);
  return searched;
}

/// Moves the camera with the newest keyframe after an adjustment.
void StereoSlam::Implementation::applyCorrectionToMotion(const std::optional<Pose>& correction) {
  if (correction) motion_.correct(normalized(Pose(*correction * motion_.last())));
}

void StereoSlam::Implementation::load(const std::string& bytes) {
  map_ = unpackMap(bytes, *camera_);
  views_.reset();
  for (const auto& [id, keyframe] : map_.keyframes()) loops_.index(id, map_);
}

const char* toString(TrackingStatus status) {
  if (status == TrackingStatus::kTracked) return "tracked";
  return status == TrackingStatus::kUnreliable ? "unreliable" : "lost";
}

StereoSlam::StereoSlam(std::shared_ptr<const StereoCamera> camera, const SlamParams& params)
    : implementation_(std::make_unique<Implementation>(std::move(camera), validated(params))) {}

StereoSlam::~StereoSlam() = default;

SlamUpdate StereoSlam::process(const stereo::FrameContext& frame, const MovingRegions& moving,
                               ImageEvidence images) {
  return implementation_->process(frame, moving, images);
}
std::string StereoSlam::save() const { return implementation_->save(); }
ByteSource StereoSlam::snapshot() const { return implementation_->snapshot(); }
void StereoSlam::load(const std::string& bytes) { implementation_->load(bytes); }
double StereoSlam::disparityOffset() const { return implementation_->disparityOffset(); }
MapView StereoSlam::map() { return implementation_->map(); }
TrajectoryVisit StereoSlam::trajectorySnapshot() const {
  return implementation_->trajectorySnapshot();
}
void StereoSlam::finish() { implementation_->finish(); }
const StageTimes& StereoSlam::times() const { return implementation_->times(); }

}  // namespace headway::slam
