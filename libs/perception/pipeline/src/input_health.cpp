// SPDX-License-Identifier: BSD-3-Clause
// Checks of the input: mounting, scale, clock, wheels and inertial sensor.
#include "input_health.h"

#include <headway/core/statistics.h>
#include <headway/core/text.h>
#include <headway/stereo/ground_plane.h>
#include <headway/stereo/rectification.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <utility>

namespace headway::pipeline {
namespace {

struct MountLimits {
  int max_images = 8;              ///< without ground, after which the check ends
  int min_without_turn = 3;        ///< of them that show the error
  int min_upside_down = 7;         ///< more, because a ceiling may look like ground
  double min_turn_rad = 0.01;      ///< between two frames; less is noise and bias
  double min_turns_rad = 0.5;      ///< sum of the compared rotations
  double contrary = 0.6;           ///< difference to rotation where the axes are wrong
  double equal = 0.25;             ///< where they are right
  double vertical = 0.7;           ///< component of the optical axis along the robot's z: 45 deg
  double max_height_error = 0.35;  ///< of the camera's height, relative
};
constexpr MountLimits kMount;

/// A pose as MRPT writes it: x y z [m], yaw pitch roll [deg].
std::string poseText(const Pose& pose) {
  const Eigen::Matrix3d R = pose.linear();
  const double pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  const double yaw = std::atan2(R(1, 0), R(0, 0));
  const double roll = std::atan2(R(2, 1), R(2, 2));
  std::string text = "[";
  for (int i = 0; i < 3; ++i) text += formatted("%.3f ", pose.translation()[i]);
  return text + formatted("%.1f %.1f %.1f] (x y z [m] yaw pitch roll [deg])", yaw / kDegree,
                          pitch / kDegree, roll / kDegree);
}

Pose turned(const Pose& T_robot_cam, const Eigen::Matrix3d& R_cam_other) {
  Pose result = T_robot_cam;
  result.linear() = T_robot_cam.linear() * R_cam_other;
  return result;
}

Pose upsideDown(const Pose& T_robot_cam) {
  return turned(T_robot_cam, Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitZ()).toRotationMatrix());
}

/// The disparity image of the camera turned by 180 degrees about its optical axis.
stereo::DisparityImage flipped(const stereo::DisparityImage& disparity, StereoCamera& camera) {
  stereo::DisparityImage result;
  result.reduce = disparity.reduce;
  cv::flip(disparity.values, result.values, -1);
  camera.cx = disparity.pixelOf(0) + disparity.pixelOf(disparity.values.cols - 1) - camera.cx;
  camera.cy = disparity.pixelOf(0) + disparity.pixelOf(disparity.values.rows - 1) - camera.cy;
  return result;
}

}  // namespace

bool MountCheck::isAtMountedHeight(const stereo::GroundPlane& ground) const {
  const auto rig = stereo::rigCapability(camera_);
  return !rig.camera_height_known || std::abs(ground.camera_height - rig.camera_height_m) <
                                         kMount.max_height_error * rig.camera_height_m;
}

bool MountCheck::showsGround(const stereo::DisparityImage& disparity,
                             const StereoCamera& camera) const {
  const auto ground = stereo::findGround(disparity, camera, std::nullopt);
  return ground && isAtMountedHeight(*ground);
}

std::optional<Finding> MountCheck::addImage(const stereo::FrameContext& context) {
  if (decided_) return std::nullopt;
  if (context.ground() && isAtMountedHeight(*context.ground())) {
    decided_ = decided_by_turns_ = true;
    return std::nullopt;
  }
  ++images_;
  const bool is_vertical = std::abs(camera_.T_robot_cam.linear()(2, 2)) > kMount.vertical;
  const auto text =
      is_vertical ? testOpticalTurn(context.disparity()) : testUpsideDown(context.disparity());
  decided_ = decided_ || images_ == kMount.max_images;
  return decide(text, context.frame().index);
}

std::optional<Finding> MountCheck::decide(const std::string& text, std::size_t frame) {
  if (text.empty()) return std::nullopt;
  decided_ = decided_by_turns_ = true;
  return Finding{"camera_pose", frame, text, Severity::kFatal};
}

std::string MountCheck::testOpticalTurn(const stereo::DisparityImage& disparity) {
  StereoCamera with_turn = camera_;
  with_turn.T_robot_cam = turned(camera_.T_robot_cam, robotFromOptical().linear());
  if (showsGround(disparity, with_turn)) ++without_turn_;
  if (without_turn_ < kMount.min_without_turn) return "";
  const bool up = camera_.T_robot_cam.linear()(2, 2) > 0.0;
  return textWithoutTurn(std::string("the camera looks straight ") + (up ? "up" : "down") +
                         ", but its images show the ground ahead");
}

std::string MountCheck::textWithoutTurn(const std::string& evidence) const {
  return "camera pose: by cameraPose = " + poseText(camera_.T_robot_cam) + " " + evidence +
         ": the pose lacks the turn to optical axes (x right, y down, z forward); write "
         "cameraPose = " +
         poseText(turned(camera_.T_robot_cam, robotFromOptical().linear()));
}

std::optional<Finding> MountCheck::addTurn(const Eigen::Matrix3d& by_camera,
                                           const Eigen::Matrix3d& by_gyroscope, std::size_t frame) {
  const Eigen::Vector3d measured = logSo3(by_gyroscope);
  if (decided_by_turns_ || measured.norm() < kMount.min_turn_rad) return std::nullopt;
  const Eigen::Matrix3d R = camera_.T_robot_cam.linear();
  const Eigen::Vector3d turn = logSo3(by_camera);
  turned_rad_ += measured.norm();
  difference_rad_ += (turn - measured).norm();
  difference_turned_rad_ +=
      (R * robotFromOptical().linear() * R.transpose() * turn - measured).norm();
  if (turned_rad_ < kMount.min_turns_rad) return std::nullopt;
  decided_by_turns_ = true;
  const bool is_contrary = difference_rad_ > kMount.contrary * turned_rad_;
  if (!is_contrary || difference_turned_rad_ >= kMount.equal * turned_rad_) return std::nullopt;
  return decide(textWithoutTurn("its turns contradict the gyroscope's (if it is right, correct the "
                                "inertial sensor's sensorPose, or leave that out by "
                                "slam.use_imu=false)"),
                frame);
}

std::string MountCheck::testUpsideDown(const stereo::DisparityImage& disparity) {
  const double up_y = stereo::mountedUp(camera_).y();
  if (std::abs(up_y) < kMount.vertical) return "";
  const bool said_upright = up_y < 0.0;
  StereoCamera turned_camera = camera_;
  turned_camera.T_robot_cam = upsideDown(camera_.T_robot_cam);
  StereoCamera flipped_camera = said_upright ? camera_ : turned_camera;
  const stereo::DisparityImage flipped_image = flipped(disparity, flipped_camera);
  if (!said_upright && showsGround(flipped_image, flipped_camera)) {
    decided_ = true;
    return "";
  }
  const bool contrary = said_upright ? showsGround(flipped_image, flipped_camera)
                                     : showsGround(disparity, turned_camera);
  if (contrary) ++upside_down_;
  if (upside_down_ < kMount.min_upside_down) return "";
  return std::string("camera pose: the images show the ground ") +
         (said_upright ? "above" : "below") +
         " the camera, but by cameraPose = " + poseText(camera_.T_robot_cam) + " it is " +
         (said_upright ? "upright" : "upside-down") +
         ": turn it about its optical axis; write cameraPose = " +
         poseText(turned_camera.T_robot_cam);
}

namespace {

/// What makes a plane a floor, and how exactly it tells the mounting.
struct FloorLimits {
  double seconds = 2.0;             ///< in which it is seen
  double max_seconds = 30.0;        ///< of slow motion
  double seen_ratio = 0.8;          ///< of these frames, in which it is where it usually is
  double height_ratio = 0.05;       ///< of the camera's height: it is there within this
  double tilt_rad = 2.5 * kDegree;  ///< and this: suspension, slopes and noise
  /// A robot tilts by load, tyres and suspension: about 1 cm in 1 m. A mounting is stated as it was
  /// measured by hand, to 1 cm and 1 cm in 1 m.
  double sigma_tilt_rad = 0.01;
  double sigma_height_m = 0.01;
  double sigma_scale = 0.01;  ///< of the depths
  // Of cameras on cars, which a mounting is assumed to be like that is not stated:
  double assumed_sigma_tilt_rad = 1.5 * kDegree;
  double assumed_sigma_height_m = 0.2;
  double heights_away = 10.0;  ///< that most of a floor is seen within: 6 degrees below the horizon
  double significance = 3.0;   ///< standard deviations
  double unit_ratio = 0.1;     ///< a factor of units is met within this
};
constexpr FloorLimits kFloorLimits;

/// A unit that distances are in, and the one that they are read in.
struct UnitFactor {
  double factor;
  const char* text;
  bool is_of_baselines;  ///< as well as of depth images
};
constexpr std::array kUnitFactors = {UnitFactor{0.001, "metres, read as millimetres", true},
                                     UnitFactor{0.2, "millimetres, read as 1/5000 m", false},
                                     UnitFactor{5.0, "1/5000 m, read as millimetres", false},
                                     UnitFactor{1000.0, "millimetres, read as metres", true}};

FloorCheck::Mounting mountingBy(const Eigen::Vector3d& up_cam, double height_m) {
  return {height_m, std::asin(std::clamp(-up_cam.z(), -1.0, 1.0)),
          std::atan2(-up_cam.x(), -up_cam.y()), Eigen::Matrix3d::Zero()};
}

Eigen::Vector3d vectorOf(const FloorCheck::Mounting& mounting) {
  return {mounting.height_m, mounting.down_rad, mounting.roll_rad};
}

std::string mountingText(const FloorCheck::Mounting& mounting) {
  return formatted("%.2f m above the floor, looking %.1f deg down, rolled by %.1f deg",
                   mounting.height_m, mounting.down_rad / kDegree, mounting.roll_rad / kDegree);
}

}  // namespace

std::optional<Finding> FloorCheck::add(Time time, std::size_t frame,
                                       const std::optional<stereo::GroundPlane>& floor,
                                       const std::optional<Pose>& T_odom_cam) {
  const bool is_after = samples_.empty() || time > samples_.back().time;
  if (!T_odom_cam || !is_after) samples_.clear();
  if (!T_odom_cam || mounting_) return std::nullopt;
  Sample sample{time, std::nullopt, T_odom_cam->translation()};
  if (floor) sample.seen = mountingBy(floor->up, floor->camera_height);
  samples_.push_back(sample);
  while (time - samples_.front().time > kFloorLimits.max_seconds) samples_.pop_front();
  mounting_ = measured();
  return mounting_ ? compare(frame) : std::nullopt;
}

/// By the newest frames over which the camera moved by its height.
std::optional<FloorCheck::Mounting> FloorCheck::measured() const {
  std::vector<Eigen::Vector3d> seen;
  std::array<std::vector<double>, 3> values;
  double count = 0.0;
  double lowest = std::numeric_limits<double>::infinity();
  for (auto sample = samples_.rbegin(); sample != samples_.rend(); ++sample) {
    count += 1.0;
    if (sample->seen) {
      seen.push_back(vectorOf(*sample->seen));
      lowest = std::min(lowest, sample->seen->height_m);
      for (int i = 0; i < 3; ++i) values[static_cast<std::size_t>(i)].push_back(seen.back()[i]);
    }
    const double seconds = samples_.back().time - sample->time;
    if (seen.empty() || seconds < kFloorLimits.seconds) continue;
    const double moved = (samples_.back().position - sample->position).norm();
    if (moved < lowest) continue;  // than any height: a robot that stands needs no medians
    const Eigen::Vector3d usual(median(values[0]), median(values[1]), median(values[2]));
    if (moved < usual[0]) continue;
    const Eigen::Array3d limits(kFloorLimits.height_ratio * usual[0], kFloorLimits.tilt_rad,
                                kFloorLimits.tilt_rad);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    double agreeing = 0.0;
    for (const Eigen::Vector3d& one : seen) {
      const Eigen::Vector3d off = one - usual;
      if ((off.array().abs() > limits).any()) continue;
      agreeing += 1.0;
      sum += off;
      squares += off * off.transpose();
    }
    if (agreeing < kFloorLimits.seen_ratio * count) return std::nullopt;
    const Eigen::Vector3d mean = sum / agreeing;
    // An offset of the disparities makes the depths of a pair wrong.
    const double by_offset = camera_.isDepthCamera()
                                 ? 0.0
                                 : stereo::kRectificationSigma_px * kFloorLimits.heights_away *
                                       usual[0] / (camera_.fx * camera_.baseline_m);
    const double sigma_scale = std::hypot(kFloorLimits.sigma_scale, by_offset);
    const Eigen::Vector3d systematic(
        std::hypot(kFloorLimits.sigma_height_m, sigma_scale * usual[0]),
        kFloorLimits.sigma_tilt_rad, kFloorLimits.sigma_tilt_rad);
    Mounting result{usual[0] + mean[0], usual[1] + mean[1], usual[2] + mean[2], {}};
    result.covariance = (squares / agreeing - mean * mean.transpose()) / agreeing;
    result.covariance.diagonal() += systematic.cwiseAbs2();
    return result;
  }
  return std::nullopt;
}

std::optional<std::string> FloorCheck::text() const {
  if (!mounting_) return std::nullopt;
  return mountingText(*mounting_) + formatted(" (+- %.2f m, %.1f deg)",
                                              std::sqrt(mounting_->covariance(0, 0)),
                                              std::sqrt(mounting_->covariance(1, 1)) / kDegree);
}

bool FloorCheck::agreesWith(const Mounting& other, double sigma_height_m,
                            double sigma_tilt_rad) const {
  const Eigen::Array3d other_sigma(sigma_height_m, sigma_tilt_rad, sigma_tilt_rad);
  Eigen::Array3d off = (vectorOf(*mounting_) - vectorOf(other)).array();
  off[2] = std::remainder(off[2], 2.0 * M_PI);
  const Eigen::Array3d sigma =
      (mounting_->covariance.diagonal().array() + other_sigma.square()).sqrt();
  return (off.abs() <= kFloorLimits.significance * sigma).all();
}

std::optional<Pose> FloorCheck::replacement() const {
  const auto rig = stereo::rigCapability(camera_);
  if (!mounting_ || rig.camera_height_known) return std::nullopt;
  if (agreesWith(mountingBy(stereo::mountedUp(camera_), rig.camera_height_m),
                 kFloorLimits.assumed_sigma_height_m, kFloorLimits.assumed_sigma_tilt_rad)) {
    return std::nullopt;
  }
  const double down = mounting_->down_rad, roll = mounting_->roll_rad;
  const Eigen::Vector3d up_cam(-std::cos(down) * std::sin(roll), -std::cos(down) * std::cos(roll),
                               -std::sin(down));
  const Eigen::Matrix3d assumed = camera_.T_robot_cam.linear();
  const Eigen::Matrix3d upright =
      Eigen::Quaterniond::FromTwoVectors(assumed * up_cam, Eigen::Vector3d::UnitZ()) * assumed;
  const Eigen::Vector3d before = assumed.col(2), after = upright.col(2);
  const double turned = std::atan2(before.y(), before.x()) - std::atan2(after.y(), after.x());
  StereoCamera found = camera_;
  found.T_robot_cam.linear() = Eigen::AngleAxisd(turned, Eigen::Vector3d::UnitZ()) * upright;
  found.T_robot_cam.translation().z() = mounting_->height_m;
  // A height that no camera is mounted at is of a wrong unit.
  if (found.T_robot_cam.translation().norm() > kMaxMountingDistance_m) return std::nullopt;
  if (!stereo::rigCapability(found).camera_height_known) return std::nullopt;
  return found.T_robot_cam;
}

std::optional<Finding> FloorCheck::compare(std::size_t frame) const {
  const std::string by_floor = "by the floor in view, the camera is " + *text();
  const auto rig = stereo::rigCapability(camera_);
  if (!rig.camera_height_known) {
    return Finding{"camera_mounting", frame,
                   by_floor + formatted("; no mounting is stated, %.2f m and level %s: write it as "
                                        "T_robot_cam of the calibration (cameraPose)",
                                        rig.camera_height_m,
                                        replacement() ? "were assumed until now" : "are assumed")};
  }
  const Mounting stated = mountingBy(stereo::mountedUp(camera_), rig.camera_height_m);
  const std::string both = by_floor + ", but it is stated to be " + mountingText(stated);
  const double ratio = mounting_->height_m / stated.height_m;
  const bool is_depth = camera_.isDepthCamera();
  for (const UnitFactor& unit : kUnitFactors) {
    if (std::abs(ratio / unit.factor - 1.0) > kFloorLimits.unit_ratio) continue;
    return Finding{
        "camera_mounting", frame,
        both + formatted(": distances are %g times those of the mounting, as of %s; "
                         "check %s, and the unit of T_robot_cam (cameraPose)",
                         unit.factor, is_depth || unit.is_of_baselines ? unit.text : "another unit",
                         is_depth ? "depth_unit_m (rangeUnits)" : "the baseline")};
  }
  if (agreesWith(stated, kFloorLimits.sigma_height_m, kFloorLimits.sigma_tilt_rad)) return {};
  return Finding{"camera_mounting", frame,
                 both + ": correct T_robot_cam of the calibration (cameraPose), or the depths"};
}

namespace {

struct ScaleLimits {
  double piece_m = 2.0;
  double straight = 0.7;          ///< minimum ratio of a piece's chord to its path
  std::size_t min_pieces = 5;     ///< that are compared
  std::size_t max_pieces = 200;   ///< that are remembered
  double said_difference = 0.01;  ///< of the scales
  double significance = 3.0;      ///< standard deviations
  double other_unit = 30.0;       ///< camera to odometry: the unit is wrong
  double other_scale = 3.0;       ///< and its inverse: said at once
};
constexpr ScaleLimits kScale;
/// Standard error of a median by the median absolute deviation of a Gaussian: 1.4826 of them are a
/// standard deviation, and the standard error is sqrt(pi / 2) of a mean's.
constexpr double kMedianError = 1.2533 * 1.4826;

}  // namespace

Findings ScaleCheck::add(const std::optional<Pose>& by_camera,
                         const std::optional<Pose>& by_odometry, std::size_t frame) {
  if (!by_camera || !by_odometry) {
    piece_ = {};
    return {};
  }
  piece_.by_camera = piece_.by_camera * *by_camera;
  piece_.by_odometry = piece_.by_odometry * *by_odometry;
  piece_.path_m += by_odometry->translation().norm();
  if (piece_.path_m < kScale.piece_m) return {};
  Findings findings;
  const double by_wheels = piece_.by_odometry.translation().norm();
  if (by_wheels > kScale.straight * piece_.path_m) {
    if (auto finding = checkUnit(frame)) findings.push_back(std::move(*finding));
    ratios_.push_back(piece_.by_camera.translation().norm() / by_wheels);
    if (ratios_.size() > kScale.max_pieces) ratios_.pop_front();
  }
  piece_ = {};
  const auto found = ratio();
  if (!found ||
      std::abs(found->value - 1.0) - kScale.significance * found->sigma < kScale.said_difference) {
    return findings;
  }
  findings.push_back(
      {"odometry_scale", frame,
       formatted("the camera moves %.3f +- %.3f times as far as the wheels say: check the "
                 "calibration's baseline and focal length, and the size of the wheels; the map has "
                 "the camera's scale",
                 found->value, found->sigma)});
  return findings;
}

std::optional<Finding> ScaleCheck::checkUnit(std::size_t frame) {
  if (std::exchange(is_unit_checked_, true)) return std::nullopt;
  const double camera_m = piece_.by_camera.translation().norm();
  const double odometry_m = piece_.by_odometry.translation().norm();
  const double ratio = camera_m / odometry_m;
  const std::string compared =
      formatted("the camera moved %.3g m where odometry measured %.3g m: ", camera_m, odometry_m);
  const bool is_depth = camera_.isDepthCamera();
  if (ratio > kScale.other_unit) {
    const std::string text =
        is_depth ? "depth camera: " + compared +
                       formatted(
                           "depths are too great, as if in another unit (rangeUnits, "
                           "depth_unit_m); multiply it by %.3g",
                           1.0 / ratio)
                 : "stereo calibration: " + compared +
                       formatted(
                           "the baseline of %.6g m is too long, as if in another unit; write "
                           "%.3g m",
                           camera_.baseline_m, camera_.baseline_m / ratio);
    return Finding{"distance_unit", frame, text, Severity::kFatal};
  }
  if (ratio <= kScale.other_scale && ratio >= 1.0 / kScale.other_scale) return std::nullopt;
  const std::string cause = is_depth ? "check the depths' unit"
                                     : formatted("check the baseline (%.6g m)", camera_.baseline_m);
  return Finding{"odometry_scale", frame,
                 compared + cause + ", and odometry's unit and wheel slip"};
}

std::optional<ScaleCheck::Ratio> ScaleCheck::ratio() const {
  if (ratios_.size() < kScale.min_pieces) return std::nullopt;
  Ratio result;
  result.value = median({ratios_.begin(), ratios_.end()});
  std::vector<double> deviations;
  for (const double one : ratios_) deviations.push_back(std::abs(one - result.value));
  result.sigma = kMedianError * median(deviations) / std::sqrt(static_cast<double>(ratios_.size()));
  return result;
}

namespace {

constexpr double kMaxTimeStep = 10.0;  ///< between frames, without a finding [s]
constexpr double kAgreement_s = 1.0;   ///< of both images, before they count again: two comparisons

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

/// Images that nothing was wrong with before they were used, but that contradict the map.
void checkRightImage(const FrameState& state, Findings& findings) {
  const bool by_map = state.camera.doubt == slam::Doubt::kImages && state.is_by_slam;
  if (!by_map || state.images != slam::ImageEvidence::kNone) return;
  findings.push_back(
      {"images_disagree", state.frame.index,
       "the right image does not show the landmarks of the left one where the map "
       "says; check the right camera's mounting, lens and trigger. No pose counts until it has "
       "shown them for a second"});
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

InputHealth::InputHealth(std::shared_ptr<const StereoCamera> camera, double max_speed_mps,
                         const stereo::DisparityParams& matching)
    : camera_(std::move(camera)), max_speed_mps_(max_speed_mps), stereo_check_(matching) {
  if (camera_ == nullptr) return;
  mount_check_.emplace(*camera_);
  floor_check_.emplace(*camera_);
  scale_check_.emplace(*camera_);
}

void InputHealth::remount(std::shared_ptr<const StereoCamera> camera) {
  camera_ = std::move(camera);
  mount_check_.emplace(*camera_);
  floor_check_->remount(*camera_);
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
  is_pair_compared_ = stereo_check_.isStarting();
  if (is_pair_compared_) comparePair(frame, findings);
  append(camera_check_.add(frame), findings);
  const bool is_one_missing = camera_check_.isOneMissing();
  if (stereo_check_.imagesContradict() || is_one_missing) disagreed_ = frame.time;
  const bool is_settled = !disagreed_ || std::abs(frame.time - *disagreed_) >= kAgreement_s;
  if (!is_settled) images_ = slam::ImageEvidence::kContradictory;
  // Nothing can be measured; before there is a map, nothing can be predicted either.
  if (is_one_missing && was_localised_) images_ = slam::ImageEvidence::kOneUseless;
  if (camera_check_.isFrozen()) images_ = slam::ImageEvidence::kSeenBefore;
}

Findings InputHealth::checkPair(const FrameState& state) {
  Findings findings;
  if (state.frame.stereo && !is_pair_compared_) comparePair(*state.frame.stereo, findings);
  return counted(std::move(findings));
}

void InputHealth::comparePair(const StereoFrame& frame, Findings& findings) {
  append(stereo_check_.add(frame), findings);
  const bool is_turned = std::exchange(turn_, stereo_check_.turn()) != stereo_check_.turn();
  if (is_turned && scale_check_) scale_check_->restart();
}

Findings InputHealth::checkResults(const FrameState& state) {
  Findings findings;
  if (is_trusted_) checkRightImage(state, findings);
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
    if (state.frame.stereo) {
      append(camera_check_.addTracked(*state.frame.stereo, state.camera.inliers), findings);
    }
  } else if (state.camera.status == slam::TrackingStatus::kLost && state.is_by_slam &&
             was_localised_) {  // otherwise it is not lost, but not localised so far
    findings.push_back(camera_check_.lossOf(*state.frame.stereo));
  }
}

void InputHealth::checkMotion(const FrameState& state, Findings& findings) {
  if (state.scans_ground && !floor_check_->mounting()) {
    std::optional<stereo::GroundPlane> floor;
    std::optional<Pose> T_odom_cam;
    if (isTracked(state)) {
      floor = stereo::findFloor(state.context->disparity(), *camera_);
      T_odom_cam = state.camera.T_odom_robot * camera_->T_robot_cam;
    }
    append(floor_check_->add(state.frame.time, state.frame.index, floor, T_odom_cam), findings);
  }
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
