// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/formatted.h>
#include <headway/pipeline/moving_regions.h>
#include <headway/pipeline/perception.h>

#include <algorithm>

namespace headway::pipeline {
namespace {

/// Of detection in live operation with a network: a pass of YOLOX-nano takes 63 ms of one core, and
/// two frames at 10 Hz have to take less than 200 ms.
constexpr int kNetworkPeriod = 2;
constexpr std::size_t kScansMovedPerFrame = 20;  ///< of the grid in live operation; about 10 ms

std::optional<Pose> poseOf(const slam::SlamUpdate& camera) {
  if (camera.status != slam::TrackingStatus::kTracked) return std::nullopt;
  return camera.T_map_robot;
}

/// What the camera can see, with the configured values in place of derived ones.
std::optional<stereo::RigCapability> rigOf(const StereoCamera* camera,
                                           const PerceptionParams& params) {
  if (camera == nullptr) return std::nullopt;
  const auto& detect = params.detection.detect;
  auto configured = params.grid.scan.configured();
  configured.nearest_m = detect.disparity.nearest_m;
  configured.vehicles_to_m = detect.stereo_motion.max_range_m;
  configured.segments_to_m = detect.stereo_motion.max_segment_range_m;
  configured.grid_spacing_m = params.grid.map.spacing_m;
  configured.dense_to_m = params.dense.reach_m;
  configured.dense_voxel_m = params.dense.voxel_m;
  configured.dense_spacing_m = params.dense.spacing_m;
  return stereo::rigCapability(*camera, configured);
}

/// Grid parameters without values to be derived.
GridParams gridFor(const std::optional<stereo::RigCapability>& rig,
                   const PerceptionParams& all_params) {
  GridParams params = all_params.grid;
  params.map.footprint = all_params.robot;
  if (!rig) return params;
  params.scan = params.scan.forRig(*rig);
  params.map.spacing_m = rig->grid_spacing_m;
  return params;
}

}  // namespace

void GridParams::describe(Params::Section section) {
  section.user().add("every_nth_frame", every_nth_frame, 0, 1000, "frames",
                     "Period of the ground scans, and of the depth scans of the dense map; greater "
                     "is faster; 0: neither grid nor dense map");
  scan.describe(section);
  map.describe(section);
}

void PerceptionParams::describe(Params& params) {
  slam.describe(params.section("slam"));
  detection.describe(params);
  objects.describe(params.section("objects"));
  grid.describe(params.section("grid"));
  dense.describe(params.section("dense"));
  laser.describe(params.section("laser"));
  robot.describe(params.section("robot").user());
}

PerceptionParams PerceptionParams::live(PerceptionParams params) {
  params.slam.adjust_in_background = true;
  if (modelInUse(params.detection).empty()) return params;
  auto& detect = params.detection.detect;
  detect.network.tiles = false;
  detect.every_nth_frame = std::max(detect.every_nth_frame, kNetworkPeriod);
  return params;
}

void PerceptionParams::validate() const {
  slam.validate();
  detection.validate();
  objects.validate();
  grid.validate();
  dense.validate();
  laser.validate();
  robot.validate();
}

Perception::Perception(std::shared_ptr<const StereoCamera> camera, const PerceptionParams& params,
                       map::PerceptionMap map)
    : camera_(std::move(camera)),
      front_end_(validated(params).detection.detect.disparity),
      detection_(camera_, params.detection),
      tracker_(params.objects),
      rig_(rigOf(camera_.get(), params)),
      grid_params_(gridFor(rig_, params)),
      laser_params_(params.laser),
      max_speed_mps_(params.slam.max_speed_mps),
      is_live_(params.slam.adjust_in_background),
      grid_(grid_params_.map),
      dense_(params.dense, rig_, is_live_),
      map_(std::move(map)),
      given_poses_(params.slam.trajectory_in_memory) {
  mapping_ = params.slam.mapping;
  if (!mapping_) grid_params_.every_nth_frame = 0;
  if (camera_ != nullptr) mount_check_.emplace(*camera_);
  if (camera_ != nullptr) slam_ = std::make_unique<slam::StereoSlam>(camera_, params.slam);
}

Perception::~Perception() = default;

PerceptionUpdate Perception::process(const RecordedFrame& frame) {
  const auto watch = times_.watch("frame");
  applyChange();
  const Warnings warnings_before = log_ ? warnings_ : Warnings();
  const map::PerceptionMap map_before = map_;
  const bool scan_ground = hasGridTurn(frame);
  PerceptionUpdate update;
  update.frame = frame.index;
  update.time = frame.time;
  auto ended = followClock(frame);
  checkImages(frame);
  const auto boxes = detection_.detectObjects(frame, contextOf(frame), scan_ground);
  update.camera = localise(frame, boxes);
  logLocalisation(frame, update.camera);
  found_ = detection_.detectMotion(frame, poseOf(update.camera), boxes, expected_, found_.motion);
  if (!isLocalisedBySlam(frame)) estimateOffset();
  if (found_.images_used) times_.add("detect", found_.elapsed_ms);
  update.detections = found_.fused;
  update.objects = track(frame, update);
  ended.insert(ended.end(), update.objects.finalised.begin(), update.objects.finalised.end());
  update.objects.finalised = std::move(ended);
  warnAboutBoxes(frame, boxes);
  checkInput(frame, update, scan_ground);
  updateMap(update);
  updateGrid(frame, update, scan_ground);
  updateDense(frame, update, scan_ground);
  tracks_ = update.objects.tracks;
  expected_ = update.objects.expected;
  last_pose_.reset();
  if (const auto pose = poseOf(update.camera)) last_pose_ = Stamped<Pose>{frame.time, *pose};
  logFrame(update, warnings_before);
  callBack(update, map_before);
  return update;
}

bool Perception::hasGridTurn(const RecordedFrame& frame) {
  const auto every_nth = static_cast<std::size_t>(grid_params_.every_nth_frame);
  if (camera_ == nullptr || !frame.stereo || every_nth == 0) return false;
  return grid_frames_++ % every_nth == 0;
}

std::optional<stereo::FrameContext> Perception::contextOf(const RecordedFrame& frame) {
  if (!frame.stereo) return std::nullopt;
  const Eigen::Vector3d& turn = stereo_check_.turn();
  if (front_end_.rightTurn().angles() != turn) {
    const Eigen::Vector3d degrees = turn * 180.0 / M_PI;
    log(LogLevel::kInfo, frame.index,
        formatted("right images are turned back by pitch %.3f, yaw %.3f, roll %.3f deg",
                  degrees.x(), degrees.y(), degrees.z()));
    if (isLocalisedBySlam(frame)) slam_->turnRightCamera(turn, !stereo_check_.hasMoved());
    offset_at_given_poses_.subtract((turn - front_end_.rightTurn().angles()).y() /
                                    stereo::yawOfOffset(1.0, *camera_));
    front_end_.setRightTurn({turn, *camera_});
    scale_check_.restart();
  }
  return front_end_.next(*frame.stereo, disparityOffset(frame));
}

bool Perception::isLocalisedBySlam(const RecordedFrame& frame) const {
  return !frame.T_map_robot && frame.stereo && slam_ != nullptr && given_poses_.empty();
}

double Perception::disparityOffset(const RecordedFrame& frame) const {
  return isLocalisedBySlam(frame) ? slam_->disparityOffset() : offset_at_given_poses_.value();
}

void Perception::estimateOffset() {
  if (found_.motion.static_points.empty()) return;
  offset_at_given_poses_.update(found_.motion.static_points);
  stereo_check_.addOffsetAtGivenPoses(offset_at_given_poses_.estimate(), *camera_);
}

slam::SlamUpdate Perception::localise(const RecordedFrame& frame, const ObjectDetections& boxes) {
  if (!isLocalisedBySlam(frame)) return useGivenPose(frame);
  const auto moving = movingRegions(boxes.sources, tracks_, found_.motion, frame.time, *camera_);
  auto update = slam_->process(*boxes.context, moving, images_);
  if (const auto offset = slam_->takeFreeOffset()) stereo_check_.addOffset(*offset, *camera_);
  return update;
}

slam::SlamUpdate Perception::useGivenPose(const RecordedFrame& frame) {
  if (frame.T_map_robot && resumed_) {
    throw InputError("frame " + std::to_string(frame.index) +
                     " brings a pose of its own, which is not in the frame of the map taken up; "
                     "use a rawlog without label 'pose'");
  }
  slam::SlamUpdate given;
  if (frame.T_map_robot) {
    given.status = slam::TrackingStatus::kTracked;
    given.T_map_robot = *frame.T_map_robot;
    given.covariance.setZero();
  } else if (!given_poses_.empty()) {
    given.T_map_robot = poseFrom(given_poses_.back().T_map_robot);
  }
  given_poses_.append(
      {frame.index, frame.time, headway::stored(given.T_map_robot), frame.T_map_robot.has_value()});
  return given;
}

objects::TrackUpdate Perception::track(const RecordedFrame& frame, const PerceptionUpdate& update) {
  const auto watch = times_.watch("objects");
  objects::TrackUpdate tracked;
  if (update.detections && poseOf(update.camera)) {
    Detections near = *update.detections;
    DropCounts far;
    shedFar(near, far);
    tracked = tracker_.update(frame.index, {frame.time, update.camera.T_map_robot}, near);
    tracked.detections_dropped.merge(far);
  } else {
    tracked = tracker_.coast(frame.index, frame.time);
    if (update.detections && !update.detections->items.empty()) {
      tracked.detections_dropped["camera_lost"] += update.detections->items.size();
    }
  }
  for (const auto& [reason, count] : found_.dropped) tracked.detections_dropped[reason] += count;
  return tracked;
}

void Perception::updateMap(const PerceptionUpdate& update) {
  const auto watch = times_.watch("map_update");
  if (update.camera.is_keyframe || update.camera.map_corrected) {
    updateStaticMap();
  } else {
    grid_.followMore(kScansMovedPerFrame);
  }
  map_.update(update.time, update.objects.tracks);
}

void Perception::updateStaticMap() {
  map_.update(slam_->map());
  if (is_live_) {
    grid_.follow(map_.staticMap()->keyframes, kScansMovedPerFrame);
  } else {
    grid_.follow(map_.staticMap()->keyframes);
  }
  dense_.follow(map_.staticMap()->keyframes);
}

void Perception::finish() {
  if (slam_ != nullptr && given_poses_.empty()) {
    slam_->finish();
    map_.update(slam_->map());
    grid_.follow(map_.staticMap()->keyframes);
    if (const auto grid = grid_.grid()) map_.update(grid);
    dense_.follow(map_.staticMap()->keyframes);
  }
  dense_.update(map_, times_);
  updateDenseMap();
}

std::vector<slam::FrameEstimate> Perception::trajectory() const {
  std::vector<slam::FrameEstimate> all;
  visitTrajectory([&](const slam::FrameEstimate& estimate) { all.push_back(estimate); });
  return all;
}

slam::TrajectoryVisit Perception::trajectorySnapshot() const {
  if (slam_ != nullptr && given_poses_.empty()) return slam_->trajectorySnapshot();
  return [poses = given_poses_.snapshot()](const slam::FrameVisitor& visit) {
    poses->visit([&](const GivenPose& given) {
      visit({given.frame, given.time, given.is_given, poseFrom(given.T_map_robot)});
    });
  };
}

StageTimes Perception::times() const {
  StageTimes all = times_;
  if (slam_ != nullptr) all.merge(slam_->times());
  return all;
}

}  // namespace headway::pipeline
