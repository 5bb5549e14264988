// SPDX-License-Identifier: BSD-3-Clause
#include "input_health.h"

#include <headway/core/text.h>

#include <cmath>
#include <iterator>
#include <utility>

namespace headway::pipeline {
namespace {

constexpr double kMaxTimeStep = 10.0;  ///< between frames, without a finding [s]

bool isTracked(const FrameState& state) { return slam::isTracked(state.camera.status); }

/// The robot's motion since the frame before in the map, whose scale bundle adjustment refines as
/// odometry's is not; nullopt where more than an adjustment moved the map.
std::optional<Pose> motionInMap(const FrameState& state) {
  const slam::MapRevision& revision = state.camera.revision;
  const bool is_moved = revision.number != state.previous.revision &&
                        revision.cause != slam::MapChange::kBundleAdjustment;
  if (!isTracked(state) || !state.T_previous_robot || is_moved) return std::nullopt;
  return state.previous.T_map_robot.inverse() * state.camera.T_map_robot;
}

void append(Findings&& more, Findings& all) {
  all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

void append(std::optional<Finding>&& more, Findings& all) {
  if (more) all.push_back(std::move(*more));
}

void checkClock(const FrameState& state, Findings& findings) {
  if (!state.previous.index) return;
  const double step = state.secondsSincePrevious();
  const std::size_t frame = state.frame.index;
  if (state.clock == ClockStep::kRepeated) {
    findings.push_back({"time_repeated", frame,
                        "the frame has the time of the one before, so that its detections are not "
                        "used; check the resolution of the images' times, and whether images are "
                        "delivered twice"});
  } else if (state.clock == ClockStep::kSetBack) {
    findings.push_back({"clock_set_back", frame,
                        formatted("the images' time goes back by %.3f s, so that all tracks end; "
                                  "let the clock be slewed instead of set (chrony, PTP)",
                                  std::abs(step))});
  } else if (step >= kMaxTimeStep) {
    findings.push_back({"clock_jumps_ahead", frame,
                        formatted("the images' time jumps ahead by %.3f s: the camera paused, or "
                                  "its clock was set",
                                  step)});
  }
}

void checkMotionPrior(const FrameState& state, Findings& findings) {
  if (!state.is_motion_left_out) return;
  findings.push_back({"motion_left_out", state.frame.index,
                      formatted("motion by wheels and inertial sensor is left out: it does not "
                                "count from frame %zu, the one before; give every frame of the "
                                "source, or join the motion of those between (joined())",
                                *state.previous.index)});
}

void checkBoxes(const FrameState& state, Findings& findings) {
  if (!state.boxes.recorded_missing) return;
  findings.push_back(
      {"recorded_boxes_missing", state.frame.index,
       "no boxes have come for longer than detect.recorded_timeout_s; with detect.detector = auto, "
       "stereo_motion detects until they return; check the detector's program"});
}

void checkSpeed(const FrameState& state, double max_speed_mps, Findings& findings) {
  if (!state.T_previous_robot) return;
  const double seconds = state.secondsSincePrevious();
  const double metres = state.T_previous_robot->translation().norm();
  if (!(seconds > 0.0) || metres <= max_speed_mps * seconds) return;
  findings.push_back(
      {"speed", state.frame.index,
       formatted("the robot moves at %.3g m/s, faster than slam.max_speed; check the "
                 "calibration's baseline and focal length, and the images' times",
                 metres / seconds)});
}

void checkWheels(const FrameState& state, Findings& findings) {
  if (state.camera.doubt != slam::Doubt::kOdometry) return;
  findings.push_back(
      {"odometry_contradicts", state.frame.index,
       "camera and wheel odometry differ by more than 3 standard deviations over the last second, "
       "so that the pose is unreliable: something large moves before the camera, or the wheels "
       "slip; if they slip most of the time, set slam.use_odometry=false"});
}

void checkInertialSensor(const FrameState& state, Findings& findings) {
  if (state.camera.imu == slam::ImuStatus::kGyroscopeContradicts) {
    findings.push_back(
        {"imu_gyroscope", state.frame.index,
         "the inertial sensor is left out: its gyroscope does not measure the camera's turns; "
         "check its axes (sensorPose), the camera's (cameraPose), and its unit (rad/s)"});
  } else if (state.camera.imu == slam::ImuStatus::kAccelerometerContradicts) {
    findings.push_back(
        {"imu_accelerometer", state.frame.index,
         "the inertial sensor is left out: its accelerometer does not measure gravity and the "
         "camera's motion; check its axes (sensorPose) and unit (m/s^2, with gravity)"});
  }
}

}  // namespace

InputHealth::InputHealth(std::shared_ptr<const StereoCamera> camera, double max_speed_mps)
    : camera_(std::move(camera)), max_speed_mps_(max_speed_mps) {
  if (camera_ == nullptr) return;
  mount_check_.emplace(*camera_);
  scale_check_.emplace(*camera_);
}

void InputHealth::resume(const Eigen::Vector3d& right_turn) {
  stereo_check_.assume(right_turn);
  turn_ = right_turn;
  was_localised_ = true;
}

RightCamera InputHealth::rightCamera() const {
  return {stereo_check_.turn(), stereo_check_.hasMoved()};
}

Findings InputHealth::checkFrame(const FrameState& state) {
  Findings findings;
  checkClock(state, findings);
  checkMotionPrior(state, findings);
  images_ = slam::ImageEvidence::kNone;
  if (state.frame.stereo) checkImages(*state.frame.stereo, findings);
  return counted(std::move(findings));
}

void InputHealth::checkImages(const StereoFrame& frame, Findings& findings) {
  append(stereo_check_.add(frame), findings);
  append(camera_check_.add(frame), findings);
  if (stereo_check_.imagesContradict()) images_ = slam::ImageEvidence::kContradictory;
  if (camera_check_.isFrozen()) images_ = slam::ImageEvidence::kSeenBefore;
  const bool is_turned = std::exchange(turn_, stereo_check_.turn()) != stereo_check_.turn();
  if (is_turned && scale_check_) scale_check_->restart();
}

Findings InputHealth::checkResults(const FrameState& state) {
  Findings findings;
  checkLoss(state, findings);
  if (state.disparity_offset && state.is_by_slam) {
    append(stereo_check_.addOffset(*state.disparity_offset, *camera_, state.frame.index), findings);
  } else if (state.disparity_offset) {
    stereo_check_.addOffsetAtGivenPoses(*state.disparity_offset, *camera_);
  }
  checkBoxes(state, findings);
  checkSpeed(state, max_speed_mps_, findings);
  checkWheels(state, findings);
  if (state.is_by_slam) checkMotion(state, findings);
  return counted(std::move(findings));
}

void InputHealth::checkLoss(const FrameState& state, Findings& findings) {
  if (isTracked(state)) {
    was_localised_ = true;
    if (state.frame.stereo) camera_check_.addTracked(*state.frame.stereo);
  } else if (state.camera.status == slam::TrackingStatus::kLost && state.is_by_slam &&
             was_localised_) {  // otherwise it is not lost, but not localised so far
    findings.push_back(camera_check_.lossOf(*state.frame.stereo));
  }
}

void InputHealth::checkMotion(const FrameState& state, Findings& findings) {
  if (state.scans_ground) append(mount_check_->addImage(*state.context), findings);
  const auto by_camera = isTracked(state) ? state.T_previous_robot : std::nullopt;
  const MotionPrior& prior = state.motion_prior;
  if (by_camera && prior.R_previous_current) {
    append(mount_check_->addTurn(by_camera->linear(), *prior.R_previous_current, state.frame.index),
           findings);
  }
  append(scale_check_->add(motionInMap(state), prior.T_previous_current, state.frame.index),
         findings);
  checkInertialSensor(state, findings);
}

Findings InputHealth::counted(Findings findings) {
  for (Finding& finding : findings) {
    if (finding.severity == Severity::kFatal) {
      finding.is_first = std::exchange(is_trusted_, false);
    } else {
      finding.is_first = warnings_.count(finding.name) == 0;
      addWarning(finding.name, finding.frame, finding.text, warnings_);
    }
  }
  return findings;
}

}  // namespace headway::pipeline
