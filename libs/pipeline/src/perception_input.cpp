// SPDX-License-Identifier: BSD-3-Clause
// The parts of Perception that compare its input with the images: mounting, sensors, static map.
#include <headway/pipeline/perception.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

namespace headway::pipeline {
namespace {

constexpr double kMaxTimeStep = 10.0;  ///< between frames, without a warning [s]

bool isTracked(const PerceptionUpdate& update) {
  return update.camera.status == slam::TrackingStatus::kTracked;
}

}  // namespace

std::vector<TrackSample> Perception::followClock(const RecordedFrame& frame) {
  const auto before = std::exchange(last_time_, frame.time);
  if (!before || (frame.time > *before && frame.time - *before < kMaxTimeStep)) return {};
  char amount[32];
  std::snprintf(amount, sizeof amount, "%.3f s", std::abs(frame.time - *before));
  if (frame.time > *before) {
    addWarning("clock_jumps_ahead", frame.index,
               std::string("the images' time jumps ahead by ") + amount +
                   ": the camera paused, or its clock was set",
               warnings_);
    return {};
  }
  addWarning("clock_set_back", frame.index,
             std::string("the images' time goes back by ") + amount +
                 ", so that all tracks end; let the clock be slewed instead of set (chrony, PTP)",
             warnings_);
  detection_.restart();
  found_ = {};
  tracks_.clear();
  expected_.clear();
  last_pose_.reset();
  return tracker_.restart();
}

void Perception::warnAboutBoxes(const RecordedFrame& frame, const ObjectDetections& boxes) {
  if (!boxes.recorded_missing) return;
  addWarning("recorded_boxes_missing", frame.index,
             "no boxes have come for longer than detect.recorded_timeout_s; with detect.detector = "
             "auto, stereo_motion detects until they return; check the detector's program",
             warnings_);
}

void Perception::checkImages(const RecordedFrame& frame) {
  images_ = slam::ImageEvidence::kNone;
  if (!frame.stereo) return;
  stereo_check_.add(*frame.stereo, warnings_);
  if (stereo_check_.imagesContradict()) images_ = slam::ImageEvidence::kContradictory;
  if (camera_check_.add(*frame.stereo, warnings_)) images_ = slam::ImageEvidence::kSeenBefore;
}

void Perception::warnAboutOdometry(const RecordedFrame& frame, const slam::SlamUpdate& camera) {
  if (camera.doubt != slam::Doubt::kOdometry) return;
  addWarning("odometry_contradicts", frame.index,
             "camera and wheel odometry differ by more than 3 standard deviations over the last "
             "second, so that the pose is unreliable: something large moves before the camera, or "
             "the wheels slip; if they slip most of the time, set slam.use_odometry=false",
             warnings_);
}

void Perception::shedFar(Detections& detections, DropCounts& dropped) const {
  if (std::isinf(max_box_range_m_)) return;
  auto& items = detections.items;
  const auto far = std::remove_if(items.begin(), items.end(), [&](const Detection& item) {
    return item.box3d && item.box3d->centre.norm() > max_box_range_m_;
  });
  if (far != items.end()) dropped["load_shed"] = static_cast<std::size_t>(items.end() - far);
  items.erase(far, items.end());
}

void Perception::warnAboutSpeed(const RecordedFrame& frame, const PerceptionUpdate& update) {
  const bool is_measured = isTracked(update) || update.camera.doubt == slam::Doubt::kSpeed;
  if (!is_measured || !last_pose_ || update.camera.map_corrected) return;
  const double seconds = frame.time - last_pose_->time;
  const double metres =
      (update.camera.T_map_robot.translation() - last_pose_->value.translation()).norm();
  if (!(seconds > 0.0) || metres <= max_speed_mps_ * seconds) return;
  char speed[32];
  std::snprintf(speed, sizeof speed, "%.3g m/s", metres / seconds);
  addWarning("speed", frame.index,
             std::string("the robot moves at ") + speed +
                 ", faster than slam.max_speed; check the calibration's baseline and focal length, "
                 "and the images' times",
             warnings_);
}

std::optional<std::string> Perception::rectification() const {
  const auto error = stereo_check_.rectification();
  if (!error || camera_ == nullptr) return std::nullopt;
  return stereo::describe(*error, *camera_, front_end_.rightTurn().angles());
}

void Perception::checkInput(const RecordedFrame& frame, const PerceptionUpdate& update,
                            bool scan_ground) {
  warnAboutSpeed(frame, update);
  warnAboutOdometry(frame, update.camera);
  if (!isLocalisedBySlam(frame)) return;
  if (scan_ground) mount_check_->addImage(*found_.context);
  if (isTracked(update) && last_pose_ && update.camera.loops.empty()) {
    const Pose by_camera = last_pose_->value.inverse() * update.camera.T_map_robot;
    const MotionPrior& prior = frame.stereo->motion_prior;
    if (prior.R_previous_current) {
      mount_check_->addTurn(by_camera.linear(), *prior.R_previous_current);
    }
    mount_check_->addMotion(by_camera, prior.T_previous_current, frame.index, warnings_);
    scale_check_.add(by_camera, prior.T_previous_current, frame.index, warnings_);
  } else {
    scale_check_.interrupt();
  }
  if (update.camera.imu == slam::ImuStatus::kGyroscopeContradicts) {
    addWarning(
        "imu_gyroscope", frame.index,
        "the inertial sensor is left out: its gyroscope does not measure the camera's turns; "
        "check its axes (sensorPose), the camera's (cameraPose), and its unit (rad/s)",
        warnings_);
  } else if (update.camera.imu == slam::ImuStatus::kAccelerometerContradicts) {
    addWarning("imu_accelerometer", frame.index,
               "the inertial sensor is left out: its accelerometer does not measure gravity and "
               "the camera's motion; check its axes (sensorPose) and unit (m/s^2, with gravity)",
               warnings_);
  }
}

const Warnings& Perception::warnings() const { return warnings_; }

void Perception::updateGrid(const RecordedFrame& frame, const PerceptionUpdate& update,
                            bool scan_ground) {
  const Pose& T_map_robot = update.camera.T_map_robot;
  std::optional<GroundScan> scan;
  if (!isTracked(update) || !frame.stereo || camera_ == nullptr ||
      grid_params_.every_nth_frame == 0) {
    addLaser(frame, update, false, scan);
    return;
  }
  if (scan_ground) {
    const auto watch = times_.watch("grid");
    scan =
        detection_.scanGround(frame, T_map_robot, found_, update.objects.tracks, grid_params_.scan);
    addLaser(frame, update, true, scan);
    if (scan) grid_.add(T_map_robot, std::move(*scan));
  } else {
    addLaser(frame, update, false, scan);
  }
  grid_.standAt(T_map_robot);
  // A scan may see nothing, such as behind a truck in the first frame.
  if (const auto grid = grid_.grid()) map_.update(grid);
}

void Perception::updateDense(const RecordedFrame& frame, const PerceptionUpdate& update,
                             bool scan_ground) {
  dense_.update(map_, times_);
  if (!scan_ground || !isTracked(update) || !dense_.isUsed()) return;
  dense_.leaveOut(update.objects.tracks, frame.time);
  const Pose& T_map_robot = update.camera.T_map_robot;
  dense_.scan(*found_.context,
              detection_.leftOutOfDenseMap(frame, T_map_robot, found_, update.objects.tracks),
              T_map_robot);
}

void Perception::updateDenseMap() { dense_.publish(map_, times_); }

void Perception::addLaser(const RecordedFrame& frame, const PerceptionUpdate& update,
                          bool scan_ground, std::optional<GroundScan>& scan) {
  if (frame.laser_scans.empty() || !laser_params_.use) return;
  const auto leave_out = [&](const char* reason) {
    laser_counts_[reason] += frame.laser_scans.size();
  };
  if (!isTracked(update)) return leave_out("camera_lost");
  if (!scan_ground) return leave_out("between_ground_scans");
  const auto ground = groundOf(found_);
  if (!ground) return leave_out("ground_unknown");
  LaserScene scene;
  scene.time = frame.time;
  scene.T_map_robot = update.camera.T_map_robot;
  if (update.camera.loops.empty()) scene.before = last_pose_;
  scene.ground = *ground;
  scene.camera = camera_->T_robot_cam.translation();
  scene.min_obstacle_height_m = grid_params_.scan.min_obstacle_height_m;
  scene.max_obstacle_height_m = grid_params_.scan.max_obstacle_height_m;
  scene.footprint = grid_params_.map.footprint;
  if (!scan) scan.emplace();
  addLaserScans(frame.laser_scans, scene, update.objects.tracks, laser_params_, *scan,
                laser_counts_);
}

std::optional<RobotGround> Perception::groundOf(const FrameDetections& found) const {
  const auto& plane = found.context ? found.context->ground() : std::nullopt;
  if (!plane) {
    if (!rig_ || !rig_->camera_height_known) return std::nullopt;
    return RobotGround{};
  }
  const Eigen::Vector3d up = camera_->T_robot_cam.linear() * plane->up;
  return RobotGround{up, plane->camera_height - up.dot(camera_->T_robot_cam.translation())};
}

const std::map<std::string, std::size_t>& Perception::laserCounts() const { return laser_counts_; }

}  // namespace headway::pipeline
