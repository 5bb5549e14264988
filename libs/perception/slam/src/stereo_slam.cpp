// SPDX-License-Identifier: BSD-3-Clause
// Stereo visual SLAM: localises each frame in the map that it builds.
#include <headway/core/error.h>
#include <headway/core/stage_times.h>
#include <headway/core/statistics.h>
#include <headway/core/stereo_camera.h>
#include <headway/slam/joint_map.h>
#include <headway/slam/stereo_slam.h>
#include <headway/stereo/rectification.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "anchored_trajectory.h"
#include "bundle_adjustment.h"
#include "frame_tracker.h"
#include "inertial_alignment.h"
#include "joint_sparse_map.h"
#include "landmark_tracker.h"
#include "local_mapper.h"
#include "loop_closer.h"
#include "map_archive.h"
#include "motion_model.h"
#include "relocaliser.h"
#include "right_image_check.h"
#include "sparse_map.h"
#include "visual_odometry.h"
#include "wheel_odometry.h"

namespace headway::slam {
namespace {

// After a change of what is assumed about the right camera:
constexpr int kReadjusted = 100;  ///< keyframes, so that none is fixed where the old scale put it
constexpr int kReadjustIterations = 20;

}  // namespace

/// Processes a frame step by step and keeps the state between frames.
class StereoSlam::Implementation {
 public:
  Implementation(std::shared_ptr<const StereoCamera> camera, const SlamParams& params)
      : camera_(std::move(camera)),
        T_cam_robot_(camera_->T_robot_cam.inverse(Eigen::Isometry)),
        params_(params),
        tracker_(*camera_, params),
        adjuster_(*camera_, params.adjust_in_background, params.stop),
        mapper_(*camera_, params, adjuster_),
        loops_(*camera_, params, adjuster_),
        motion_(camera_->T_robot_cam, params),
        visual_odometry_(*camera_, params),
        motion_in_odom_(camera_->T_robot_cam, params),
        odometry_since_tracked_(params.use_odometry),
        views_(T_cam_robot_),
        trajectory_(params.trajectory_in_memory) {}

  SlamUpdate process(const stereo::FrameContext& context, const MovingRegions& moving,
                     ImageEvidence images) {
    LoopProgress searched = takeBackgroundWork();
    const StereoFrame& frame = context.frame();
    rate_.add(frame.time);
    tracker_.setInterval(rate_.interval());
    const bool is_repeated = !canMeasure(images);
    const bool stands = standstill_check_.add(frame.time, frame.motion_prior, !is_repeated);
    const bool has_wheels = params_.use_odometry && frame.motion_prior.T_previous_current;
    // Where one image of two comes again, the other one shows that the camera moves.
    const bool is_pair_repeated = images == ImageEvidence::kSeenBefore;
    const bool may_stand = has_wheels ? stands : is_pair_repeated && !isMotionVisible(frame);
    const bool is_held = is_repeated && may_stand && reference_ && lost_in_a_row_ == 0;
    const bool is_frozen = is_repeated && !is_held && !(has_wheels && stands);
    TrackingFrame current;
    std::optional<TrackedPose> tracked;
    {
      const auto watch = times_.watch("slam_track");
      mapper_.addOdometry(frame.motion_prior);
      odometry_since_tracked_.add(frame.motion_prior);
      turns_known_ = turns_known_ && params_.use_imu && frame.motion_prior.R_previous_current;
      current = makeTrackingFrame(context, moving, *camera_, params_);
      if (!is_frozen && !is_held) tracked = track(context, current, moving);
    }
    const auto watch = times_.watch("slam_map");
    SlamUpdate update = is_held     ? held()
                        : is_frozen ? passOver(frame, current)
                                    : localised(frame, current, tracked, images);
    update.imu = inertial_.status();
    if (!searched.attempts.empty()) update.loops = std::move(searched.attempts);
    describePose(update);
    is_cause_kept_ = false;
    trajectory_.add(current.index, current.time, isTracked(update.status), motion_.last(),
                    reference_, map_);
    if (update.status == TrackingStatus::kLost || is_held || is_frozen) return update;
    odometry_since_tracked_.restartAt(*reference_);
    last_tracked_ = current.time;
    turns_known_ = seen_since_tracked_ = true;
    covariance_when_tracked_ = covariance_;
    previous_ = std::move(current);
    return update;
  }

  void finish() {
    const LoopProgress searched = loops_.finish(map_);
    followMap(changeOf(searched.attempts), searched.correction);
    followMap(MapChange::kBundleAdjustment, adjuster_.finish(map_));
  }

  void load(const std::string& bytes) {
    map_ = unpackMap(bytes, *camera_);
    views_.reset();
    for (const auto& [id, keyframe] : map_.keyframes()) loops_.index(id, map_);
  }

  void correct(const KeyframePoses& poses) {
    adjuster_.abandon();
    loops_.abandon();
    if (reference_) {
      const Pose T_reference_cam =
          map_.keyframe(*reference_).T_map_cam.inverse(Eigen::Isometry) * motion_.last();
      motion_.correct(normalized(Pose(poses.at(*reference_) * T_reference_cam)));
      noteChange(MapChange::kMapsJoined);
    }
    applyCorrection(poses, map_);
  }

  [[nodiscard]] const SparseMap& sparseMap() const { return map_; }
  [[nodiscard]] const StereoCamera& camera() const { return *camera_; }
  [[nodiscard]] const SlamParams& params() const { return params_; }
  [[nodiscard]] std::string save() const { return packMap(map_, *camera_); }
  [[nodiscard]] ByteSource snapshot() const { return mapBytes(map_, *camera_); }
  [[nodiscard]] double disparityOffset() const { return map_.disparityOffset(); }
  [[nodiscard]] std::optional<stereo::OffsetEstimate> takeFreeOffset() {
    return adjuster_.takeFreeOffset();
  }

  void turnRightCamera(const Eigen::Vector3d& angles, bool always_so) {
    visual_odometry_.turnRightCamera(map_.rightTurn(), angles);
    if (!params_.mapping || angles == map_.rightTurn()) return;
    if (!always_so || !reference_) return map_.setRightTurn(angles);
    adjuster_.abandon();
    loops_.abandon();
    for (TrackedLandmark& seen : seen_before_) {
      stereo::StereoMeasurement& measured = seen.measurement;
      measured.disparity = stereo::turnedDisparity(measured.uv, measured.disparity,
                                                   map_.rightTurn(), angles, *camera_);
    }
    std::map<KeyframeId, Pose> before;
    for (const auto& [id, keyframe] : map_.keyframes()) before[id] = keyframe.T_map_cam;
    Pose T_reference_cam = before.at(*reference_).inverse(Eigen::Isometry) * motion_.last();
    slam::turnRightCamera(angles, *camera_, map_);
    const KeyframeId newest = map_.keyframes().rbegin()->first;
    adjustBundle(map_, map_.neighbourhood(newest, kReadjusted), *camera_, kReadjustIterations,
                 params_.stop);
    const auto ratios = scaleChanges(before, map_);
    trajectory_.scale(ratios);
    const auto here = ratios.find(*reference_);
    if (here != ratios.end()) T_reference_cam.translation() *= here->second;
    motion_.correct(normalized(Pose(map_.keyframe(*reference_).T_map_cam * T_reference_cam)));
    measureLastPoseAgain();
    noteChange(MapChange::kRightCamera);
    local_landmarks_ = map_.seenBy(map_.neighbourhood(*reference_, params_.window));
  }

  void remount(std::shared_ptr<const StereoCamera> camera) {
    adjuster_.abandon();
    loops_.abandon();
    camera_ = std::move(camera);
    T_cam_robot_ = camera_->T_robot_cam.inverse(Eigen::Isometry);
    adjuster_.remount(camera_->T_robot_cam);
    motion_.remount(camera_->T_robot_cam);
    motion_in_odom_.remount(camera_->T_robot_cam);
    views_ = MapViewMaker(T_cam_robot_);
    odometry_check_.restart();
    if (map_.keyframes().empty()) return;
    const Pose& T_map_first = map_.keyframes().begin()->second.T_map_cam;
    const Pose shift =
        normalized(Pose(camera_->T_robot_cam * T_map_first.inverse(Eigen::Isometry)));
    std::map<KeyframeId, Pose> poses;
    for (const auto& [id, key] : map_.keyframes()) poses[id] = normalized(shift * key.T_map_cam);
    applyCorrection(poses, map_);
    motion_.correct(normalized(shift * motion_.last()));
    motion_in_odom_.correct(normalized(shift * motion_in_odom_.last()));
    inertial_.rotateMap(shift.linear());
    noteChange(MapChange::kMounting);
  }

  void setInitialPose(const Pose& T_map_robot) {
    relocaliser_.expect(T_map_robot * camera_->T_robot_cam);
  }

  [[nodiscard]] MapView map() { return views_.make(map_, submap()); }
  [[nodiscard]] MapView map(int submap) const { return makeMapView(map_, T_cam_robot_, submap); }
  [[nodiscard]] TrajectoryVisit trajectorySnapshot() const {
    return trajectory_.snapshot(map_, T_cam_robot_);
  }
  [[nodiscard]] const StageTimes& times() const { return times_; }

 private:
  /// Tracks from the last pose, or else relocalises in the whole map.
  std::optional<TrackedPose> track(const stereo::FrameContext& context, TrackingFrame& current,
                                   const MovingRegions& moving) {
    relocalised_ = false;
    if (!reference_) initialiseMotion(context);
    relocaliser_.moveExpected(motion_in_odom_.last());
    std::optional<Pose> proposed;
    auto step = visual_odometry_.propose(current, predictedStep(context.frame()));
    if (map_.keyframes().empty()) return std::nullopt;
    const bool is_wide = !step;
    if (is_wide) step = visual_odometry_.proposeWide(current);
    if (step) proposed = normalized(motion_.last() * *step);
    const std::vector<Pose> initial_poses{motion_.predict(context.frame()), motion_.last()};
    std::optional<TrackedPose> tracked;
    if (is_wide && proposed) {
      // Few of the landmarks before are still in view.
      tracked =
          tracker_.measureLocalMap(current, *proposed, local_landmarks_, map_, params_.min_inliers);
    }
    if (!tracked) {
      tracked = tracker_.track(previous_, seen_before_, current, proposed, initial_poses,
                               local_landmarks_, active_submap_.isNew(rate_), map_);
    }
    if (!tracked && !current.excluded.empty() && !moving.boxes.empty()) {
      // Boxes leave too little in view. They contain static background, of which the landmarks are.
      TrackingFrame without_boxes = current;
      without_boxes.excluded = moving.mask;
      tracked = tracker_.track(previous_, seen_before_, without_boxes, proposed, initial_poses,
                               local_landmarks_, active_submap_.isNew(rate_), map_);
    }
    const auto isLed = [&](const Pose& T_map_cam) {
      return isNear(initial_poses.front(), T_map_cam) || (proposed && isNear(*proposed, T_map_cam));
    };
    if (tracked && (lost_in_a_row_ == 0 || isLed(tracked->T_map_cam))) return found(tracked);
    const Pose moved = step ? *step : predictedStep(context.frame());
    const Pose T_odom_cam = motion_in_odom_.last() * moved;
    const Pose led = motion_.last() * moved;
    current.up = upWhereItStands(context);
    const auto allows = [&](const LocatedCamera& place) {
      const bool is_way_known = reference_ && map_.submapOf(place.keyframe) == submap();
      return !is_way_known ||
             isAllowed(place.tracked.T_map_cam, led, context.frame().time - last_tracked_);
    };
    auto located = relocaliser_.locate(current, lost_in_a_row_, T_odom_cam, isLed, allows, map_);
    if (!located) return std::nullopt;
    relocalised_ = true;
    setReferenceKeyframe(located->keyframe);
    active_submap_.relocaliseAt(located->keyframe);
    return found(std::move(located->tracked));
  }

  std::optional<TrackedPose> found(std::optional<TrackedPose> tracked) {
    relocaliser_.end(submap() == 0);
    return tracked;
  }

  /// Direction away from the ground, camera frame, if the robot stands on the ground in view.
  [[nodiscard]] std::optional<Eigen::Vector3d> upWhereItStands(
      const stereo::FrameContext& context) const {
    const auto& ground = context.ground();
    if (!ground) return std::nullopt;
    const double height = camera_->T_robot_cam.translation().z();
    const bool stands = std::abs(ground->camera_height - height) <= ground->clearance_m;
    return stands ? std::optional(ground->up) : std::nullopt;
  }

  /// Whether a lost camera is found where odometry leads, which is known well enough that no place
  /// that looks alike can be meant.
  [[nodiscard]] bool isNear(const Pose& predicted, const Pose& T_map_cam) const {
    constexpr double kNear = 1.0;  ///< less than half a bay of racks [m]
    if (!reference_) return false;
    const PoseCovariance of_way = covariance_ - covariance_when_tracked_;
    const Pose T_predicted_cam = predicted.inverse(Eigen::Isometry) * T_map_cam;
    return of_way.diagonal().head<3>().maxCoeff() < square(1.5 * kNear) &&
           T_predicted_cam.translation().norm() < kNear && T_predicted_cam(2, 2) > 0.8;
  }

  /// The robot's first pose: upright as it is mounted, or as gravity tells where it is not.
  void initialiseMotion(const stereo::FrameContext& context) {
    const StereoFrame& frame = context.frame();
    Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
    const auto up_ground = [&]() -> std::optional<Eigen::Vector3d> {
      if (!context.ground()) return std::nullopt;
      return Eigen::Vector3d(camera_->T_robot_cam.linear() * context.ground()->up);
    };
    if (params_.use_imu) up = inertial_.initialUp(frame.motion_prior, up_ground);
    motion_.initialise(frame.time, up);
    if (!motion_in_odom_.isStarted()) motion_in_odom_ = motion_;
  }

  /// Turns the map about its origin where gravity shows that it is not level.
  ///
  /// @param sigma_m  of the camera's motion between both frames
  void levelMap(const StereoFrame& frame, const Stamped<Pose>& previous, const Pose& T_map_cam,
                double sigma_m) {
    if (!params_.use_imu) return;
    const Pose T_previous_current = previous.value.inverse(Eigen::Isometry) * T_map_cam;
    const CameraStep step{frame.time - previous.time, previous.value * T_cam_robot_,
                          camera_->T_robot_cam * T_previous_current * T_cam_robot_, sigma_m};
    const auto rotation = inertial_.add(step, frame.motion_prior);
    if (inertial_.isLeftOut()) {
      motion_.disableImu();
      motion_in_odom_.disableImu();
    }
    if (!rotation || !params_.mapping) return;
    const Pose turn(*rotation);
    adjuster_.abandon();
    loops_.abandon();
    std::map<KeyframeId, Pose> poses;
    for (const auto& [id, key] : map_.keyframes()) {
      if (key.submap == submap()) poses[id] = normalized(turn * key.T_map_cam);
    }
    applyCorrection(poses, map_);
    motion_.correct(normalized(turn * motion_.last()));
    noteChange(MapChange::kGravity);
  }

  /// Takes the pose that was tracked, if one was, and all that sets the motion before against it.
  SlamUpdate localised(const StereoFrame& frame, const TrackingFrame& current,
                       std::optional<TrackedPose>& tracked, ImageEvidence images) {
    const Stamped<Pose> previous{previous_.time, motion_.last()};
    const bool tracked_twice = tracked && !relocalised_ && lost_in_a_row_ == 0;
    const Pose T_map_cam = tracked ? tracked->T_map_cam : Pose::Identity();
    const double sigma_m = tracked ? positionSigma(tracked->covariance) : 0.0;
    Doubt doubt = Doubt::kNone;
    std::optional<Pose> tracked_step;
    if (tracked_twice) {
      const Pose T_previous_current = previous.value.inverse(Eigen::Isometry) * T_map_cam;
      tracked_step = T_previous_current;
      const MeasuredStep step{frame.time, camera_->T_robot_cam * T_previous_current * T_cam_robot_,
                              sigma_m, rotationSigma(tracked->covariance)};
      doubt = doubtOf(step, frame.time - previous.time, frame.motion_prior);
    } else {
      odometry_check_.restart();
      inertial_.interrupt();
    }
    moveOdometry(frame, current, doubt != Doubt::kSpeed, tracked_step);
    if (tracked && !tracked_twice) noteChange(MapChange::kRelocalised);
    const bool is_map_new = active_submap_.isNew(rate_);
    right_image_.add(tracked && !is_map_new ? &*tracked : nullptr, current, map_, *camera_,
                     params_);
    if (right_image_.isContradictory()) images = ImageEvidence::kContradictory;
    SlamUpdate update = tracked ? accept(current, *tracked) : handleLost(frame, current);
    update.doubt = doubt;
    if (tracked_twice) {
      levelMap(frame, previous, T_map_cam, std::hypot(sigma_m, previous_sigma_m_));
    }
    previous_sigma_m_ = sigma_m;
    if (update.status != TrackingStatus::kTracked) return update;
    if (images == ImageEvidence::kContradictory) update.doubt = Doubt::kImages;
    if (update.doubt != Doubt::kNone) update.status = TrackingStatus::kUnreliable;
    return update;
  }

  /// Moves the robot in the odometry frame: by the images alone, else as it was tracked in the map
  /// or as predicted.
  ///
  /// @param is_followed   whether the images may be used, and those of the frame before
  /// @param tracked_step  the camera's motion in the map; nullopt if it was not tracked in both
  void moveOdometry(const StereoFrame& frame, const TrackingFrame& current, bool is_followed,
                    const std::optional<Pose>& tracked_step) {
    const double seconds = motion_in_odom_.secondsTo(frame.time);
    std::optional<Pose> step;
    if (is_followed) {
      step = visual_odometry_.advance(current, tracked_step);
      const bool is_too_fast =
          step && seconds > 0.0 && step->translation().norm() > params_.max_speed_mps * seconds;
      if (!step || is_too_fast) step = tracked_step;
    } else {
      visual_odometry_.restart(current);
    }
    is_step_seen_ = step.has_value();
    seen_since_tracked_ = seen_since_tracked_ && is_step_seen_;
    coasted_ = step ? *step : predictedStep(frame);
    const Pose& last = motion_in_odom_.last();
    if (!step) return motion_in_odom_.coast(frame.time, normalized(last * coasted_));
    motion_in_odom_.update(frame.time, normalized(last * *step));
  }

  /// The camera's motion since the frame before as odometry predicts it, no faster than a robot is.
  [[nodiscard]] Pose predictedStep(const StereoFrame& frame) const {
    const Pose& last = motion_in_odom_.last();
    Pose step = last.inverse(Eigen::Isometry) * motion_in_odom_.predict(frame);
    const double metres = step.translation().norm();
    const double max_metres = params_.max_speed_mps * motion_in_odom_.secondsTo(frame.time);
    const bool is_too_fast = max_metres > 0.0 && metres > max_metres;
    if (is_too_fast) step.translation() *= max_metres / metres;  // wheels that are wrong
    return step;
  }

  /// What the calibration leaves unknown of the camera's pose in its submap.
  [[nodiscard]] PoseCovariance calibrationCovariance() const {
    if (!reference_) return PoseCovariance::Zero();
    const Pose& T_map_origin = map_.firstOf(submap()).T_map_cam;
    const auto seen_px = camera_->isDepthCamera() ? std::nullopt : medianDisparity(seen_before_);
    return slam::calibrationCovariance(T_map_origin.inverse(Eigen::Isometry) * motion_.last(),
                                       seen_px ? map_.offsetSigma() / *seen_px : 0.0);
  }

  /// Pose and covariance in both frames, and the submap.
  void describePose(SlamUpdate& update) const {
    update.T_map_robot = normalized(motion_.last() * T_cam_robot_);
    const PoseCovariance of_camera = covariance_ + calibrationCovariance();
    update.covariance = composedCovariance(of_camera, T_cam_robot_, PoseCovariance::Zero());
    update.T_odom_robot = normalized(motion_in_odom_.last() * T_cam_robot_);
    update.is_motion_seen = is_step_seen_;
    update.T_map_odom =
        normalized(update.T_map_robot * update.T_odom_robot.inverse(Eigen::Isometry));
    // T_odom_robot is known exactly: it defines the odometry frame.
    update.map_odom_covariance = composedCovariance(
        update.covariance, update.T_odom_robot.inverse(Eigen::Isometry), PoseCovariance::Zero());
    update.revision = revision_;
    update.submap = submap();
    if (update.status == TrackingStatus::kTracked && update.submap != 0) {
      update.status = TrackingStatus::kTrackedInNewSubmap;
    }
  }

  /// What contradicts a motion that was measured.
  Doubt doubtOf(const MeasuredStep& step, double seconds, const MotionPrior& prior) {
    const bool agrees = !params_.use_odometry || odometry_check_.add(step, prior);
    const double metres = step.T_previous_current.translation().norm();
    if (seconds > 0.0 && metres > params_.max_speed_mps * seconds) return Doubt::kSpeed;
    return agrees ? Doubt::kNone : Doubt::kOdometry;
  }

  /// The camera is tracked: choose its reference keyframe or insert a new one.
  SlamUpdate accept(const TrackingFrame& current, TrackedPose& tracked) {
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
    active_submap_.addTracked(secondsOfFrame());
    const auto chosen = referenceOf(tracked.landmarks, *reference_, params_, camera_->width, map_);
    if (!chosen && right_image_.mayExtend()) {
      makeKeyframe(current, tracked, update);
    } else if (chosen && *chosen != *reference_) {
      setReferenceKeyframe(*chosen);
    }
    seen_before_ = std::move(tracked.landmarks);
    update.features = static_cast<int>(seen_before_.size());
    seen_before_.insert(seen_before_.end(), tracked.dynamic_outliers.begin(),
                        tracked.dynamic_outliers.end());
    return update;
  }

  /// The camera is lost: predict its pose, and initialise a new submap after a while.
  SlamUpdate handleLost(const StereoFrame& frame, const TrackingFrame& current) {
    SlamUpdate update;
    coast(frame);
    const bool is_over =
        seen_since_tracked_ ||
        active_submap_.isOver(lost_in_a_row_, lost_s_, params_.restart_after_s, rate_);
    const bool is_first = map_.keyframes().empty();
    // A beginning that is given up leaves its number, if nothing else remains of the map.
    const bool is_last = active_submap_.isNew(rate_) && !is_first &&
                         active_submap_.first() == map_.keyframes().begin()->first;
    const bool is_bridged = !is_first && !is_last && isBridged(frame);
    const bool keeps_submap = is_first || is_last || is_bridged;
    const int submap = keeps_submap ? this->submap() : map_.newSubmap();
    const bool may_begin = is_first || (is_over && right_image_.mayExtend());
    if (params_.mapping && may_begin && initialise(current, submap)) {
      lost_in_a_row_ = 0;
      if (!is_first) noteChange(is_bridged ? MapChange::kBridged : MapChange::kNewSubmap);
      update.status = TrackingStatus::kTracked;
      update.is_keyframe = true;
      update.inliers = update.features = static_cast<int>(seen_before_.size());
    }
    return update;
  }

  /// The pose of a frame that is not found in the map is that by visual odometry, else the
  /// predicted one. Its covariance grows by that of the visual step, or of wheel odometry since the
  /// last tracked frame, or without both as if the robot's velocity had changed at once.
  void coast(const StereoFrame& frame) {
    constexpr double kStartSigma = 1.0;  ///< of a robot or a hand that starts or stops [m/s, rad/s]
    constexpr double kGyroscopeSigma = 0.05;  ///< of consumer gyroscopes with scale errors [rad/s]
    const double before_s = lost_in_a_row_ > 0 ? lost_s_ : 0.0;
    lost_s_ = (lost_in_a_row_++ > 0 ? lost_s_ : 0.0) + secondsOfFrame();
    if (!reference_) return;
    motion_.coast(frame.time, normalized(motion_.last() * coasted_));
    if (is_step_seen_) {
      covariance_ = composedCovariance(covariance_, coasted_, visual_odometry_.stepCovariance());
    } else if (const auto& link = odometry_since_tracked_.link()) {
      covariance_ = predictedCovariance(covariance_when_tracked_, *link);
    } else {
      const double growth_s2 = square(lost_s_) - square(before_s);
      const double turn_sigma = turns_known_ ? kGyroscopeSigma : kStartSigma;
      covariance_.diagonal().head<3>().array() += square(kStartSigma) * growth_s2;
      covariance_.diagonal().tail<3>().array() += square(turn_sigma) * growth_s2;
    }
  }

  /// Covariance of the camera's pose after a motion of the robot by wheel odometry.
  [[nodiscard]] PoseCovariance predictedCovariance(const PoseCovariance& before,
                                                   const OdometryLink& link) const {
    const auto of_robot = composedCovariance(before, T_cam_robot_, PoseCovariance::Zero());
    const auto moved = composedCovariance(of_robot, link.T_from_this, covarianceOf(link));
    return composedCovariance(moved, camera_->T_robot_cam, PoseCovariance::Zero());
  }

  /// Whether the camera's motion since its images were new shows in images: as its velocity then
  /// predicts it, or as of a robot that started at once.
  [[nodiscard]] bool isMotionVisible(const StereoFrame& frame) const {
    constexpr double kAcceleration = 1.0;  ///< of a robot or a hand, as in coast() [m/s^2, rad/s^2]
    constexpr double kSigmas = 2.0;        ///< of a corner's place, beyond which a shift shows
    const Pose T_cam_map = motion_.last().inverse(Eigen::Isometry);
    const Pose T_now_before = predictedStep(frame).inverse(Eigen::Isometry);
    std::vector<double> shifts, inverse_depths;
    for (const TrackedLandmark& seen : seen_before_) {
      const Landmark* landmark = map_.find(seen.id);
      if (landmark == nullptr) continue;
      const Eigen::Vector3d point = T_cam_map * landmark->position;
      const auto before = project(point, *camera_);
      const auto now = project(T_now_before * point, *camera_);
      if (!before || !now) continue;
      shifts.push_back((*now - *before).head<2>().norm());
      inverse_depths.push_back(1.0 / point.z());
    }
    if (shifts.empty()) return true;
    const double metres = 0.5 * kAcceleration * square(frame.time - previous_.time);
    const double shift_of_start = camera_->fx * metres * (1.0 + median(inverse_depths));
    return std::max(median(shifts), shift_of_start) > kSigmas * params_.sigma_px;
  }

  /// The images were seen before, and nothing says that the camera has moved since.
  [[nodiscard]] SlamUpdate held() const {
    SlamUpdate update;
    update.status = TrackingStatus::kTracked;
    update.inliers = update.features = static_cast<int>(seen_before_.size());
    return update;
  }

  /// The images were seen before, while the robot may move on.
  SlamUpdate passOver(const StereoFrame& frame, const TrackingFrame& current) {
    moveOdometry(frame, current, false, std::nullopt);
    coast(frame);
    odometry_check_.restart();
    inertial_.interrupt();
    SlamUpdate update;
    update.status = TrackingStatus::kUnreliable;
    update.doubt = Doubt::kFrozen;
    return update;
  }

  /// Inserts a first keyframe at the predicted pose; false, and no change, with too few landmarks.
  bool initialise(const TrackingFrame& current, int submap) {
    std::vector<TrackedLandmark> landmarks;
    const KeyframeId id =
        mapper_.insert(current, motion_.last(), covariance_, submap, landmarks, map_);
    if (static_cast<int>(landmarks.size()) < params_.min_inliers) {
      map_.removeKeyframe(id);
      return false;
    }
    loops_.index(id, map_);
    setReferenceKeyframe(id);
    if (active_submap_.isNew(rate_)) removeSubmap(active_submap_.first(), id);
    active_submap_.initialise(id);
    seen_before_ = std::move(landmarks);
    return true;
  }

  /// Inserts the frame as a keyframe, closes loops, and removes redundant keyframes.
  void makeKeyframe(const TrackingFrame& current, TrackedPose& tracked, SlamUpdate& update) {
    update.is_keyframe = true;
    const auto in_reference = [&](const Pose& T_map_cam) {
      return Pose(map_.keyframe(*reference_).T_map_cam.inverse(Eigen::Isometry) * T_map_cam);
    };
    const Pose as_tracked = in_reference(tracked.T_map_cam);
    const KeyframeId id =
        mapper_.insert(current, tracked.T_map_cam, covariance_, submap(), tracked.landmarks, map_);
    trajectory_.followAdjustment(*reference_, as_tracked, in_reference(map_.keyframe(id).T_map_cam),
                                 current.time);
    loops_.index(id, map_);
    if (params_.loop_closing) update.loops = loops_.closeOrSearch(current, id, map_);
    motion_.correct(map_.keyframe(id).T_map_cam);
    noteChange(changeOf(update.loops));
    while (const auto redundant = redundantKeyframe(id, params_.window, map_)) {
      remove(*redundant, replacementKeyframe(*redundant, map_));
    }
    setReferenceKeyframe(id);
  }

  /// Sets the keyframe whose neighbourhood the next frames are tracked against.
  void setReferenceKeyframe(KeyframeId keyframe) {
    reference_ = keyframe;
    local_landmarks_ = map_.seenBy(map_.neighbourhood(keyframe, params_.window));
  }

  /// Removes an abandoned submap, the keyframes from `first` up to `end`, its replacement.
  void removeSubmap(KeyframeId first, KeyframeId end) {
    auto at = map_.keyframes().lower_bound(first);
    while (at != map_.keyframes().end() && at->first < end) remove((at++)->first, end);
  }

  /// Removes a keyframe; the frames anchored to it are reassigned to another.
  void remove(KeyframeId keyframe, KeyframeId replacement) {
    trajectory_.reassign(keyframe, replacement, map_);
    loops_.remove(keyframe);
    map_.removeKeyframe(keyframe);
  }

  /// Applies what finished in the background.
  LoopProgress takeBackgroundWork() {
    const auto watch = times_.watch("slam_background");
    followMap(MapChange::kBundleAdjustment, adjuster_.applyFinished(map_));
    LoopProgress searched = loops_.advance(map_);
    followMap(changeOf(searched.attempts), searched.correction);
    return searched;
  }

  /// Moves the camera with the newest keyframe after a change of the map between two frames.
  void followMap(MapChange cause, const std::optional<Pose>& correction) {
    if (!correction) return;
    motion_.correct(normalized(Pose(*correction * motion_.last())));
    measureLastPoseAgain();
    noteChange(cause);
  }

  void noteChange(MapChange cause) {
    ++revision_.number;
    if (is_cause_kept_ && cause == MapChange::kBundleAdjustment) return;
    revision_.cause = cause;
    is_cause_kept_ = cause != MapChange::kBundleAdjustment;
  }

  /// What a search for loops did to the map, apart from the adjustment of the newest keyframes.
  [[nodiscard]] MapChange changeOf(const std::vector<LoopAttempt>& attempts) const {
    for (const LoopAttempt& attempt : attempts) {
      if (attempt.outcome != LoopOutcome::kClosed) continue;
      return attempt.joins_submaps ? MapChange::kSubmapJoined : MapChange::kLoop;
    }
    return MapChange::kBundleAdjustment;
  }

  /// The landmarks around the camera have moved, and not as a rigid body: where they are now, the
  /// measurements of the last frame give its pose, from which the next step is measured.
  void measureLastPoseAgain() {
    if (lost_in_a_row_ > 0) return;
    const auto refined = tracker_.poseOf(seen_before_, motion_.last(), map_);
    if (refined) motion_.correct(*refined);
  }

  /// Time since the frame before, of which a pause of the camera counts a second [s].
  [[nodiscard]] double secondsOfFrame() const {
    return std::min(rate_.lastInterval(), MotionModel::kMaxGap_s);
  }

  /// Whether the way since the last tracked frame is known: by images, by wheel odometry, or for as
  /// long as a velocity may be extrapolated by the gyroscope.
  [[nodiscard]] bool isBridged(const StereoFrame& frame) const {
    if (!reference_) return false;
    return seen_since_tracked_ || odometry_since_tracked_.link() ||
           (turns_known_ && frame.time - last_tracked_ <= MotionModel::kMaxGap_s);
  }

  /// That the camera is in; the one with the map's origin while it was not found in any.
  [[nodiscard]] int submap() const { return reference_ ? map_.submapOf(*reference_) : 0; }

  std::shared_ptr<const StereoCamera> camera_;
  Pose T_cam_robot_;
  SlamParams params_;
  FrameTracker tracker_;
  BundleAdjuster adjuster_;
  LocalMapper mapper_;
  LoopCloser loops_;
  Relocaliser relocaliser_{loops_};
  MotionModel motion_;
  VisualOdometry visual_odometry_;
  MotionModel motion_in_odom_;
  MapRevision revision_;
  Pose coasted_ = Pose::Identity();  ///< motion of a camera that is lost, since the frame before
  bool is_step_seen_ = false;        ///< that motion, in the images
  bool seen_since_tracked_ = false;  ///< in every frame since the last tracked one
  bool is_cause_kept_ = false;       ///< it is of this frame, and more than an adjustment
  InertialAlignment inertial_;
  OdometryCheck odometry_check_;
  StandstillCheck standstill_check_;
  KeyframeOdometry odometry_since_tracked_;  ///< from the last tracked frame
  SparseMap map_;
  MapViewMaker views_;
  AnchoredTrajectory trajectory_;
  StageTimes times_;

  TrackingFrame previous_;                              ///< the last one that was tracked
  std::vector<TrackedLandmark> seen_before_;            ///< landmarks of that frame
  std::optional<KeyframeId> reference_;                 ///< keyframe that it belongs to
  std::vector<LandmarkId> local_landmarks_;             ///< those around that keyframe
  PoseCovariance covariance_ = PoseCovariance::Zero();  ///< of the last camera pose
  PoseCovariance covariance_when_tracked_ = PoseCovariance::Zero();  ///< in the last such frame
  double previous_sigma_m_ = 0.0;  ///< of its position in the local map
  Time last_tracked_ = 0.0;        ///< time of that frame [s]
  bool turns_known_ = false;       ///< by the gyroscope, in every frame since then
  ActiveSubmap active_submap_;
  RightImageCheck right_image_;
  int lost_in_a_row_ = 0;
  double lost_s_ = 0.0;  ///< in these frames
  FrameRate rate_;
  bool relocalised_ = false;  ///< the newest pose, in the whole map: no motion from the one before
};

const char* toString(TrackingStatus status) {
  if (status == TrackingStatus::kTracked) return "tracked";
  if (status == TrackingStatus::kTrackedInNewSubmap) return "tracked_in_new_submap";
  return status == TrackingStatus::kUnreliable ? "unreliable" : "lost";
}

const char* toString(MapChange cause) {
  constexpr const char* kNames[] = {"start",       "bundle_adjustment", "gravity", "right_camera",
                                    "relocalised", "new_submap",        "loop",    "submap_joined",
                                    "maps_joined", "mounting",          "bridged"};
  return kNames[static_cast<std::size_t>(cause)];
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

std::vector<JointMap> joinMaps(const std::vector<const StereoSlam*>& runs) {
  std::vector<const SparseMap*> maps;
  const auto& first = runs.front()->implementation_;
  for (const StereoSlam* run : runs) {
    if (const auto difference =
            differenceBetween(run->implementation_->camera(), first->camera())) {
      throw InputError("the runs have different cameras: " + *difference);
    }
    maps.push_back(&run->implementation_->sparseMap());
  }
  std::vector<JointMap> result;
  for (const auto& group : joinSparseMaps(maps, first->camera(), first->params())) {
    JointMap& joint = result.emplace_back();
    joint.links = group.links;
    for (std::size_t i = 0; i < group.members.size(); ++i) {
      JointMember& member = joint.members.emplace_back();
      member.run = group.members[i];
      member.keyframe_shift = group.shifts[i];
      for (const auto& [id, keyframe] : maps[member.run]->keyframes()) {
        const KeyframeId here{id.value + member.keyframe_shift};
        member.poses[id] = group.map.keyframe(here).T_map_cam;
      }
    }
    joint.saved = mapBytes(group.map, first->camera());
    joint.view = makeMapView(group.map, first->camera().T_robot_cam.inverse(Eigen::Isometry), 0);
  }
  return result;
}

void StereoSlam::turnRightCamera(const Eigen::Vector3d& angles, bool always_so) {
  implementation_->turnRightCamera(angles, always_so);
}

const Eigen::Vector3d& StereoSlam::rightTurn() const {
  return implementation_->sparseMap().rightTurn();
}

std::optional<stereo::OffsetEstimate> StereoSlam::takeFreeOffset() {
  return implementation_->takeFreeOffset();
}

MapView StereoSlam::map(int submap) const { return implementation_->map(submap); }

std::vector<int> StereoSlam::submaps() const { return implementation_->sparseMap().submaps(); }

void StereoSlam::setInitialPose(const Pose& T_map_robot) {
  implementation_->setInitialPose(T_map_robot);
}

void StereoSlam::correct(const KeyframePoses& poses) { implementation_->correct(poses); }

void StereoSlam::remount(std::shared_ptr<const StereoCamera> camera) {
  implementation_->remount(std::move(camera));
}

}  // namespace headway::slam
