// SPDX-License-Identifier: BSD-3-Clause
// The pipeline of one frame: detectors, SLAM, objects, map; and maps of several runs, joined.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/core/worker_thread.h>
#include <headway/pipeline/perception.h>
#include <headway/slam/joint_map.h>
#include <mrpt/core/exceptions.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <utility>
#include <vector>

#include "input_health.h"
#include "localisation.h"
#include "mapping.h"

namespace headway::pipeline {

namespace {

using slam::TrackingStatus;

ClockStep clockStep(const RecordedFrame& frame, const PreviousFrame& previous) {
  if (!previous.index || frame.time > previous.time) return ClockStep::kAhead;
  return frame.time == previous.time ? ClockStep::kRepeated : ClockStep::kSetBack;
}

/// Whether what a frame brings of its motion counts from another frame than the previous one.
bool countsFromAnother(const RecordedFrame& frame, const PreviousFrame& previous) {
  const MotionPrior& prior = frame.stereo->motion_prior;
  const bool has_motion =
      prior.T_previous_current || prior.R_previous_current || prior.velocity_increment;
  if (!has_motion || !previous.index) return has_motion;
  return prior.previous_frame.value_or(frame.index - 1) != *previous.index;
}

/// Poses of the frame, of which SLAM's are not trusted if the input is not.
void setPoses(bool is_input_trusted, FrameState& state) {
  slam::SlamUpdate& camera = state.camera;
  if (!is_input_trusted && isTracked(camera.status)) {
    camera.status = TrackingStatus::kUnreliable;
    camera.doubt = slam::Doubt::kImages;
  }
  const bool is_tracked = isTracked(camera.status);
  if (is_tracked) state.T_map_robot = camera.T_map_robot;
  if (state.clock == ClockStep::kRepeated) return;
  if (is_tracked) state.T_odom_robot = camera.T_odom_robot;
  if (!state.previous.T_odom_robot) return;
  if (is_tracked) {
    state.T_previous_robot = state.previous.T_odom_robot->inverse() * camera.T_odom_robot;
  } else if (camera.doubt == slam::Doubt::kSpeed) {
    state.T_previous_robot = state.previous.T_map_robot.inverse() * camera.T_map_robot;
  }
}

/// Removes boxes that are too far, and counts them.
template <typename IsFar>
void dropFar(const char* reason, const IsFar& is_far, Detections& detections, DropCounts& dropped) {
  auto& items = detections.items;
  const auto far = std::remove_if(items.begin(), items.end(), [&](const Detection& item) {
    return item.box3d && is_far(item.box3d->centre);
  });
  if (far != items.end()) dropped[reason] += static_cast<std::size_t>(items.end() - far);
  items.erase(far, items.end());
}

PreviousFrame previousFrom(const FrameState& state) {
  PreviousFrame previous;
  previous.index = state.frame.index;
  previous.time = state.frame.time;
  previous.T_map_robot = state.camera.T_map_robot;
  previous.lost_in_a_row = state.previous.lost_in_a_row;
  if (state.camera.status == TrackingStatus::kLost && state.is_by_slam) ++previous.lost_in_a_row;
  if (isTracked(state.camera.status)) previous.lost_in_a_row = 0;
  previous.revision = state.camera.revision.number;
  previous.T_odom_robot = state.T_odom_robot;
  previous.tracks = state.objects.tracks;
  previous.expected = state.objects.expected;
  previous.motion = state.found.motion;
  return previous;
}

std::string describe(const slam::LoopAttempt& loop) {
  const char* outcome = "closed";
  if (loop.outcome == slam::LoopOutcome::kNotRecognised) outcome = "not recognised";
  if (loop.outcome == slam::LoopOutcome::kTooFewInliers) outcome = "rejected: too few inliers";
  if (loop.outcome == slam::LoopOutcome::kTooFarOff) outcome = "rejected: offset too large";
  std::string text = formatted("loop to keyframe %lld %s: inliers %d, required %d",
                               static_cast<long long>(loop.candidate.value), outcome, loop.inliers,
                               loop.inliers_needed);
  if (loop.offset_allowed_m == 0.0) return text;
  return text + formatted("; offset %.2f m, allowed %.2f m", loop.offset_m, loop.offset_allowed_m);
}

/// How a camera that was lost has a pose again: found at a place of the map, or carried on.
std::string describeRelocalisation(const FrameState& state, const slam::MapView& map) {
  const slam::MapChange cause = state.camera.revision.cause;
  if (cause == slam::MapChange::kStart) {
    return formatted("the map begins after %zu frames that could not be localised",
                     state.previous.lost_in_a_row);
  }
  if (cause == slam::MapChange::kBridged) {
    return formatted(
        "the map goes on where odometry led in %zu lost frames: no place of it was "
        "recognised",
        state.previous.lost_in_a_row);
  }
  if (cause == slam::MapChange::kNewSubmap && state.camera.submap == 0) {
    return formatted("the map begins anew after %zu lost frames: little of it was seen before",
                     state.previous.lost_in_a_row);
  }
  if (cause == slam::MapChange::kNewSubmap) {
    return formatted("submap %d, whose place in the map is not known, after %zu lost frames",
                     state.camera.submap, state.previous.lost_in_a_row);
  }
  const slam::KeyframeView* nearest = nullptr;
  double distance = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d place = state.camera.T_map_robot.translation();
  for (const auto& keyframe : map.keyframes) {
    const double d = (keyframe.T_map_robot.translation() - place).norm();
    if (d < distance) {
      distance = d;
      nearest = &keyframe;
    }
  }
  const std::string at = nearest == nullptr
                             ? "in a new map"
                             : formatted("%.2f m from keyframe %lld (frame %zu)", distance,
                                         static_cast<long long>(nearest->id.value), nearest->frame);
  return formatted("localised again after %zu lost frames, %s, %.2f m from the predicted position",
                   state.previous.lost_in_a_row, at.c_str(),
                   (place - state.previous.T_map_robot.translation()).norm());
}

int largestSubmap(const slam::StereoSlam& slam) {
  const auto submaps = slam.submaps();
  if (submaps.size() == 1) return submaps.front();
  int largest = 0;
  std::size_t keyframes = 0;
  for (const int submap : submaps) {
    const std::size_t count = slam.map(submap).keyframes.size();
    if (count > keyframes) largest = submap;
    keyframes = std::max(keyframes, count);
  }
  return largest;
}

std::string describe(const FrameState& state) {
  const slam::SlamUpdate& camera = state.camera;
  std::string line = formatted(
      "%s, %d landmarks%s; %zu boxes, %zu used; %zu tracks, %zu finalised samples",
      slam::toString(camera.status), camera.inliers, camera.is_keyframe ? ", keyframe" : "",
      state.found.fused ? state.found.fused->items.size() : 0, state.objects.detections_used,
      state.objects.tracks.size(), state.objects.finalised.size());
  for (const auto& [reason, count] : state.objects.detections_dropped) {
    line += "; dropped " + std::to_string(count) + " " + reason;
  }
  return line;
}

}  // namespace

/// Where the odometry frame was in the map at the frames in which tracks may still be smoothed, so
/// that their samples are in the map as it was published then.
class OdometryHistory {
 public:
  void add(std::size_t frame, const Pose& T_map_odom) {
    poses_[frame] = T_map_odom;
    if (poses_.size() > kMaxFrames) poses_.erase(poses_.begin());
  }

  /// Samples of frames that were added, from the odometry frame.
  void moveIntoMap(std::vector<TrackSample>& samples) const {
    for (TrackSample& sample : samples) {
      const auto at = poses_.lower_bound(sample.frame);
      if (at != poses_.end()) sample.track = transformed(std::move(sample.track), at->second);
    }
  }

 private:
  static constexpr std::size_t kMaxFrames = 10000;  ///< the longest smoothing window at 500 Hz
  std::map<std::size_t, Pose> poses_;
};

/// The stages of the pipeline, each with the state that it keeps from frame to frame, and what the
/// previous frame left.
class Perception::Implementation {
 public:
  Implementation(std::shared_ptr<const StereoCamera> rig, const PerceptionParams& params,
                 map::PerceptionMap map);

  [[nodiscard]] PerceptionUpdate process(const RecordedFrame& recorded, const LocalCall& on_local) {
    requireUsable(recorded);
    const auto watch = times.watch("frame");
    const auto mounting = localisation.isResumed() ? std::nullopt : health.replacedMounting();
    if (mounting) remount(*mounting);
    const std::optional<RecordedFrame> reduced = inside(recorded);
    const RecordedFrame& frame = reduced ? *reduced : recorded;
    const map::PerceptionMap map_before = mapping.map();
    applyChange();
    FrameState state = begin(frame);
    state.add(health.checkFrame(state));
    state.images = health.imageEvidence();
    // What was seen before is no news of what moves or of what is free.
    const bool is_new = slam::canMeasure(state.images);
    state.scans_ground = is_new && mapping.takesTurn(frame, rate_);
    state.scans_local = is_new && frame.stereo && mapping.hasLocalLayer();
    state.context = rectify(state);
    state.boxes = detection.detectObjects(frame, state.context, is_new,
                                          state.scans_ground || state.scans_local);
    localise(state);
    state.found = detectBeside(state, [&] {
      mapping.updateLocal(state, times);
      if (on_local) on_local(state.camera, mapping.map());
    });
    state.disparity_offset = localisation.disparityOffset(state);
    odometry.add(frame.index, state.camera.T_map_odom);
    state.objects = track(state);
    state.add(health.checkResults(state));
    state.add(health.checkPair(state));
    mapping.update(state, times);
    previous_ = previousFrom(state);
    return published(std::move(state), map_before);
  }

  /// Moves the run into a joint map: its static layers become those of its part. @return T_map_run
  [[nodiscard]] Pose moveInto(const slam::KeyframePoses& poses) {
    if (poses.empty()) return Pose::Identity();
    auto& slam = *localisation.slam();
    const Pose before = slam.map(0).keyframes.front().T_map_robot;
    slam.correct(poses);
    mapping.show(0, slam, times);
    mapping.finish(times);
    mapping.update(previous_.time, std::vector<Track>(), Pose::Identity());
    const Pose now = mapping.map().staticMap()->keyframes.front().T_map_robot;
    return normalized(Pose(now * before.inverse(Eigen::Isometry)));
  }

  /// The camera is mounted otherwise than was assumed: map and odometry move, tracks end.
  void remount(const Pose& T_robot_cam) {
    auto found = std::make_shared<StereoCamera>(*given);
    found->T_robot_cam = T_robot_cam;
    T_robot_assumed_ = normalized(Pose(T_robot_cam * camera->T_robot_cam.inverse(Eigen::Isometry) *
                                       T_robot_assumed_.value_or(Pose::Identity())));
    given = std::move(found);
    camera = scale.reduced(given);
    health.remount(camera);
    localisation.remount(camera);
    detection.remount(camera);
    mapping.remount(camera, params, times);
    ended_ = tracker.restart();
    forgetMotion();
  }

  PerceptionParams params;
  std::shared_ptr<const StereoCamera> given;   ///< of the input; null if it has no images
  ImageScale scale;                            ///< of the images inside
  std::shared_ptr<const StereoCamera> camera;  ///< of those
  InputHealth health;
  Localisation localisation;
  DetectionStage detection;
  objects::MovingObjectTracker tracker;
  OdometryHistory odometry;
  Mapping mapping;
  LogSink log;
  PerceptionCallbacks callbacks;
  StageTimes times;
  std::mutex change_mutex;
  std::optional<RuntimeParams> change;  ///< for the next frame; guarded by change_mutex
  std::optional<Pose> initial_pose;     ///< the same

 private:
  /// Before anything changes, so that a frame that cannot be used leaves all as it is.
  void requireUsable(const RecordedFrame& frame) const {
    if (frame.T_map_robot && localisation.isResumed()) {
      throw InputError(
          "frame " + std::to_string(frame.index) +
          " contains a pose, which is not in the frame of the loaded map; use a rawlog "
          "without label 'pose'");
    }
    if (frame.stereo && given != nullptr) stereo::requireImages(*frame.stereo, *given);
  }

  void applyChange() {
    const std::lock_guard lock(change_mutex);
    const auto place = std::exchange(initial_pose, std::nullopt);
    if (place && localisation.slam() != nullptr) localisation.slam()->setInitialPose(*place);
    if (!change) return;
    detection.change(change->detect_period_s, change->recorded_timeout_s);
    max_box_range_m_ = change->max_box_range_m;
    mapping.setPeriod(change->grid_period_s);
    change.reset();
  }

  [[nodiscard]] FrameState begin(const RecordedFrame& frame) {
    rate_.add(frame.time);
    mapping.setRate(rate_.hz());
    FrameState state(frame, previous_, rate_, scale);
    state.ended = std::exchange(ended_, {});
    state.clock = clockStep(frame, previous_);
    if (state.clock == ClockStep::kSetBack) {
      const auto ended = restart();
      state.ended.insert(state.ended.end(), ended.begin(), ended.end());
    }
    state.is_by_slam = localisation.isBySlam(frame);
    if (!frame.stereo) return state;
    state.motion_prior = frame.stereo->motion_prior;
    if (!countsFromAnother(frame, previous_)) return state;
    state.motion_prior = {};
    state.motion_prior.specific_force = frame.stereo->motion_prior.specific_force;
    state.is_motion_left_out = previous_.index.has_value();
    return state;
  }

  /// Discards what refers to the times before. @return ended tracks
  [[nodiscard]] std::vector<TrackSample> restart() {
    detection.restart();
    forgetMotion();
    return tracker.restart();
  }

  void forgetMotion() {
    previous_.T_odom_robot.reset();
    previous_.tracks.clear();
    previous_.expected.clear();
    previous_.motion = {};
  }

  /// The frame with reduced images; and what the camera and the inertial sensor in it see of the
  /// robot, as the robot is mounted under them: wheels and lasers are of a robot that stands on the
  /// floor. nullopt: nothing changes.
  [[nodiscard]] std::optional<RecordedFrame> inside(const RecordedFrame& recorded) const {
    if (!T_robot_assumed_ && scale.isOne()) return std::nullopt;
    RecordedFrame frame = scale.reduced(recorded);
    if (frame.stereo) frame.stereo->camera = camera;
    if (!T_robot_assumed_) return frame;
    if (frame.detections) {
      frame.detections->T_robot_sensor = *T_robot_assumed_ * frame.detections->T_robot_sensor;
    }
    if (!frame.stereo) return frame;
    MotionPrior& prior = frame.stereo->motion_prior;
    const Eigen::Matrix3d R = T_robot_assumed_->linear();
    if (auto& turn = prior.R_previous_current) turn = R * *turn * R.transpose();
    if (auto& increment = prior.velocity_increment) increment = R * *increment;
    if (auto& force = prior.specific_force) force = R * *force;
    return frame;
  }

  [[nodiscard]] std::optional<stereo::FrameContext> rectify(const FrameState& state) {
    const Eigen::Vector3d before = localisation.rightTurn();
    const RightCamera right_camera = health.rightCamera();
    auto context = localisation.contextOf(state, right_camera);
    if (localisation.rightTurn() != before) {
      mapping.setRightTurn(localisation.rightTurn(), right_camera.has_moved, times);
      const Eigen::Vector3d degrees = localisation.rightTurn() / kDegree;
      write(LogLevel::kInfo, state,
            formatted("right images are turned back by pitch %.3f, yaw %.3f, roll %.3f deg",
                      degrees.x(), degrees.y(), degrees.z()));
    }
    return context;
  }

  void localise(FrameState& state) {
    state.camera = localisation.localise(state);
    setPoses(health.isTrusted(), state);
    const std::uint64_t revision = state.camera.revision.number;
    if (state.camera.is_keyframe || revision != previous_.revision ||
        state.camera.submap != mapping.submap()) {
      state.static_map = localisation.slam()->map();
      state.submaps = localisation.slam()->submaps();
    }
    if (state.T_map_robot && state.is_by_slam && state.previous.lost_in_a_row > 0 && log) {
      write(LogLevel::kInfo, state, describeRelocalisation(state, *mapping.map().staticMap()));
    }
    if (callbacks.on_pose) callbacks.on_pose(state.frame.time, state.camera);
  }

  /// Detects objects in another thread while this one does work that neither reads nor writes what
  /// detection writes; after it, if that work does not use the images.
  template <typename Work>
  [[nodiscard]] FrameDetections detectBeside(const FrameState& state, const Work& work) {
    const auto detect = [&] {
      return detection.detectMotion(state.frame, state.T_odom_robot, state.boxes,
                                    state.previous.expected, state.previous.motion);
    };
    if (!state.scans_local) {
      work();
      return reported(detect());
    }
    {  // What both use of the images is made when it is first used.
      const auto watch = times.watch("ground");
      (void)state.context->ground();
      (void)state.context->reducedLeft();
    }
    auto detecting = detector_.run(detect);
    try {
      work();
    } catch (...) {
      detecting.wait();
      throw;
    }
    return reported(detecting.get());
  }

  /// Drops and counts what is out of reach.
  [[nodiscard]] FrameDetections reported(FrameDetections found) {
    if (found.fused) {
      const auto is_far = [this](const Eigen::Vector3d& centre) {
        return centre.norm() > reach_.max_range_m || centre.z() > reach_.max_depth_m;
      };
      dropFar("too_far", is_far, *found.fused, found.dropped);
    }
    if (found.images_used) times.add("detect", found.elapsed_ms);
    return found;
  }

  [[nodiscard]] objects::TrackUpdate track(const FrameState& state) {
    const auto watch = times.watch("objects");
    const RecordedFrame& frame = state.frame;
    objects::TrackUpdate tracked;
    if (state.found.fused && state.T_odom_robot) {
      Detections near = *state.found.fused;
      DropCounts far;
      const auto is_far = [this](const auto& centre) { return centre.norm() > max_box_range_m_; };
      dropFar("load_shed", is_far, near, far);
      tracked = tracker.update(frame.index, {frame.time, *state.T_odom_robot}, near);
      tracked.detections_dropped.merge(far);
    } else {
      tracked = tracker.coast(frame.index, frame.time);
      if (state.found.fused && !state.found.fused->items.empty()) {
        const char* reason = state.T_map_robot ? "time_repeated" : "camera_lost";
        tracked.detections_dropped[reason] += state.found.fused->items.size();
      }
    }
    for (const auto& [reason, count] : state.found.dropped) {
      tracked.detections_dropped[reason] += count;
    }
    auto& finalised = tracked.finalised;
    finalised.insert(finalised.begin(), state.ended.begin(), state.ended.end());
    return tracked;
  }

  /// The results of the frame, after the host was called back with them.
  [[nodiscard]] PerceptionUpdate published(FrameState&& state,
                                           const map::PerceptionMap& before) const {
    logFrame(state);
    PerceptionUpdate update;
    update.frame = state.frame.index;
    update.time = state.frame.time;
    update.camera = std::move(state.camera);
    if (state.found.fused) update.detections = scale.enlarged(std::move(*state.found.fused));
    update.objects = std::move(state.objects);
    update.tracks_odom = scale.enlarged(
        std::exchange(update.objects.tracks, mapping.map().movingObjects().tracks()));
    odometry.moveIntoMap(update.objects.finalised);
    update.findings = std::move(state.findings);
    if (callbacks.on_tracks) callbacks.on_tracks(update.time, update.objects.tracks);
    const map::PerceptionMap& map = mapping.map();
    const bool has_changed = map.staticMap() != before.staticMap() ||
                             map.staticGrid() != before.staticGrid() ||
                             map.dense() != before.dense();
    if (has_changed && callbacks.on_map) callbacks.on_map(map);
    return update;
  }

  void write(LogLevel level, const FrameState& state, const std::string& text) const {
    if (log) log(level, "frame " + std::to_string(state.frame.index) + ": " + text);
  }

  void logFrame(const FrameState& state) const {
    if (!log) return;
    for (const Finding& finding : state.findings) {
      if (finding.is_first) write(LogLevel::kWarn, state, finding.text);
    }
    for (const auto& loop : state.camera.loops) write(LogLevel::kInfo, state, describe(loop));
    const slam::MapRevision& revision = state.camera.revision;
    if (revision.number != state.previous.revision &&
        revision.cause != slam::MapChange::kBundleAdjustment) {
      write(LogLevel::kInfo, state,
            formatted("revision %llu of the map: %s",
                      static_cast<unsigned long long>(revision.number),
                      slam::toString(revision.cause)));
    }
    write(LogLevel::kDebug, state, describe(state));
  }

  PreviousFrame previous_;
  std::vector<TrackSample> ended_;       ///< of tracks that ended between two frames
  std::optional<Pose> T_robot_assumed_;  ///< the robot frame of the input; nullopt: the same
  FrameRate rate_;
  objects::ConsistencyParams reach_;  ///< of boxes and tracks, whichever detector found them
  double max_box_range_m_ = RuntimeParams().max_box_range_m;
  WorkerThread detector_;
};

/// Bounds all objects, whichever detector found them, by what a depth camera measures and by the
/// range that the user allows.
static objects::ObjectsParams withinReach(const PerceptionParams& params,
                                          const StereoCamera* camera) {
  objects::ObjectsParams bounded = params.objects;
  double& max_depth_m = bounded.consistency.max_depth_m;
  const double allowed_m = params.detection.detect.stereo_motion.max_range_m;
  if (allowed_m > 0.0) max_depth_m = std::min(max_depth_m, allowed_m);
  if (camera != nullptr && camera->isDepthCamera()) {
    max_depth_m = std::min(max_depth_m, camera->depth_reach_m);
  }
  return bounded;
}

Perception::Implementation::Implementation(std::shared_ptr<const StereoCamera> rig,
                                           const PerceptionParams& all, map::PerceptionMap map)
    : params(all),
      given(std::move(rig)),
      scale(given.get(), validated(params).camera.scale),
      camera(scale.reduced(given)),
      health(camera, params.slam.max_speed_mps, params.detection.detect.disparity),
      localisation(camera, params),
      detection(camera, params.detection),
      tracker(withinReach(params, camera.get())),
      mapping(camera, params, std::move(map)),
      reach_(withinReach(params, camera.get()).consistency) {}

Perception::Perception(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
                       map::PerceptionMap map)
    : implementation_(std::make_unique<Implementation>(std::move(camera), params, std::move(map))) {
}

Perception::~Perception() = default;

PerceptionUpdate Perception::process(const RecordedFrame& frame, const LocalCall& on_local) {
  return implementation_->process(frame, on_local);
}

void Perception::resume(const map::StoredMap& stored) {
  const auto known = [](const StereoCamera& camera) {
    return stereo::rigCapability(camera).camera_height_known;
  };
  Localisation& localisation = implementation_->localisation;
  const auto& camera = implementation_->camera;
  if (stored.camera && camera != nullptr && known(*stored.camera) && !known(*camera)) {
    implementation_->remount(stored.camera->T_robot_cam);
  }
  localisation.load(stored);
  implementation_->health.resume(localisation.rightTurn());
  implementation_->mapping.load(stored, localisation.slam()->map());
  implementation_->mapping.setRightTurn(localisation.rightTurn(), true, implementation_->times);
}

map::StoredMap Perception::stored() const {
  map::StoredMap stored = implementation_->mapping.stored();
  if (implementation_->given != nullptr) stored.camera = *implementation_->given;
  if (const auto* slam = implementation_->localisation.slam()) {
    stored.made_attachments[map::kSlamAttachment] = slam->snapshot();
    implementation_->mapping.attachScans(stored);
  }
  return stored;
}

void Perception::finish() {
  Mapping& mapping = implementation_->mapping;
  if (auto* slam = implementation_->localisation.slam()) {
    slam->finish();
    mapping.show(largestSubmap(*slam), *slam, implementation_->times);
  }
  mapping.finish(implementation_->times);
}

std::shared_ptr<const StereoCamera> Perception::camera() const { return implementation_->given; }

const std::optional<stereo::RigCapability>& Perception::rig() const {
  return implementation_->mapping.rig();
}

void Perception::setLog(LogSink sink) { implementation_->log = std::move(sink); }

void Perception::setCallbacks(PerceptionCallbacks callbacks) {
  implementation_->callbacks = std::move(callbacks);
}

void Perception::change(const RuntimeParams& params) {
  ASSERTMSG_(params.detect_period_s >= 0.0 && params.grid_period_s >= 0.0 &&
                 params.recorded_timeout_s > 0.0 && params.max_box_range_m > 0.0,
             "parameters at run time are out of range");
  const std::lock_guard lock(implementation_->change_mutex);
  implementation_->change = params;
}

void Perception::setInitialPose(const Pose& T_map_robot) {
  const std::lock_guard lock(implementation_->change_mutex);
  implementation_->initial_pose = T_map_robot;
}

const Warnings& Perception::warnings() const { return implementation_->health.warnings(); }

std::optional<std::string> Perception::mounting() const {
  return implementation_->health.mounting();
}

std::optional<std::string> Perception::rectification() const {
  const auto error = implementation_->health.rectification();
  if (!error || implementation_->camera == nullptr) return std::nullopt;
  return stereo::describe(*error, *implementation_->camera,
                          implementation_->localisation.rightTurn());
}

const std::map<std::string, std::size_t>& Perception::laserCounts() const {
  return implementation_->mapping.laserCounts();
}

const map::PerceptionMap& Perception::map() const { return implementation_->mapping.map(); }

std::vector<Submap> Perception::otherSubmaps() {
  const auto* slam = implementation_->localisation.slam();
  return slam == nullptr ? std::vector<Submap>() : implementation_->mapping.others(*slam);
}

std::size_t Perception::submapCount() const {
  const auto* slam = implementation_->localisation.slam();
  return slam == nullptr ? 1 : std::max<std::size_t>(1, slam->submaps().size());
}

void Perception::updateDenseMap() {
  implementation_->mapping.updateDensePoints(implementation_->times);
}

std::vector<slam::FrameEstimate> Perception::trajectory() const {
  std::vector<slam::FrameEstimate> all;
  visitTrajectory([&](const slam::FrameEstimate& estimate) { all.push_back(estimate); });
  return all;
}

slam::TrajectoryVisit Perception::trajectorySnapshot() const {
  return implementation_->localisation.trajectorySnapshot();
}

std::vector<TrackSample> Perception::flush() {
  auto samples = implementation_->tracker.flush();
  implementation_->odometry.moveIntoMap(samples);
  return samples;
}

StageTimes Perception::times() const {
  StageTimes all = implementation_->times;
  implementation_->localisation.mergeTimes(all);
  return all;
}

namespace {

/// Ids of keyframes follow the runs' times, so that the latest scan of a place is the one that
/// remains.
std::vector<const slam::JointMember*> inOrderOfTime(const std::vector<slam::JointMember>& members) {
  std::vector<const slam::JointMember*> ordered;
  for (const auto& member : members) ordered.push_back(&member);
  std::sort(ordered.begin(), ordered.end(),
            [](const auto* a, const auto* b) { return a->keyframe_shift < b->keyframe_shift; });
  return ordered;
}

bool startsBefore(const JointMap& a, const JointMap& b) { return a.runs.front() < b.runs.front(); }

}  // namespace

std::vector<JointMap> joinMaps(const std::vector<Perception*>& perceptions) {
  std::vector<Perception::Implementation*> runs;
  for (Perception* perception : perceptions) runs.push_back(perception->implementation_.get());
  std::vector<JointMap> maps;
  std::vector<const slam::StereoSlam*> by_slam;
  std::vector<std::size_t> run_of;  // of each of them
  for (std::size_t run = 0; run < runs.size(); ++run) {
    const auto* slam = runs[run]->localisation.slam();
    if (slam == nullptr) {
      maps.push_back({{run}, {Pose::Identity()}, 0, perceptions[run]->stored()});
      continue;
    }
    by_slam.push_back(slam);
    run_of.push_back(run);
  }
  for (auto& joint : by_slam.empty() ? std::vector<slam::JointMap>() : slam::joinMaps(by_slam)) {
    JointMap& map = maps.emplace_back(JointMap{{}, {}, joint.links, {}});
    const bool is_alone = joint.members.size() == 1;
    for (const auto& member : joint.members) {
      const std::size_t run = run_of[member.run];
      map.runs.push_back(run);
      map.T_map_run.push_back(is_alone ? Pose::Identity() : runs[run]->moveInto(member.poses));
    }
    const auto& first = *runs[map.runs.front()];
    if (is_alone) map.stored = perceptions[map.runs.front()]->stored();
    if (is_alone) continue;
    map::StaticGrid grid(first.mapping.gridParams());
    map::DenseMap dense = first.mapping.dense().emptyMap();
    for (const auto& member : inOrderOfTime(joint.members)) {
      grid.add(runs[run_of[member->run]]->mapping.grid(), member->keyframe_shift);
      dense.add(runs[run_of[member->run]]->mapping.dense().map(), member->keyframe_shift);
    }
    map.stored.camera = *first.given;
    map.stored.map.update(std::move(joint.view));
    if (const auto cells = grid.grid()) map.stored.map.update(cells);
    if (const auto points = dense.layer()) map.stored.map.update(points);
    map.stored.attachments[map::kGridAttachment] = grid.save();
    map.stored.made_attachments[map::kDenseAttachment] = dense.save();
    map.stored.made_attachments[map::kSlamAttachment] = std::move(joint.saved);
  }
  std::sort(maps.begin(), maps.end(), startsBefore);
  return maps;
}

}  // namespace headway::pipeline
