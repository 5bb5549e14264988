// SPDX-License-Identifier: BSD-3-Clause
#include "frame_collector.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <cmath>

#include "observation_stream.h"
#include "recorded_gnss.h"
#include "useful_observations.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;

constexpr double kMaxPositionM = 1e7;      // of a robot in its map, which may be a UTM zone's
constexpr double kMaxPoseJumpM = 100.0;    // between two recorded poses, besides:
constexpr double kMaxSpeed = 100.0;        // of a robot [m/s]
constexpr double kMaxSensorOffsetM = 1e3;  // of a sensor on its robot
constexpr double kMaxInertialValue = 1e4;  // [m/s^2, rad/s]
constexpr double kMaxLaserRangeM = 1e4;
constexpr double kMaxRotationError = 1e-3;
constexpr std::size_t kMaxFixes = 100000;  // between two frames
constexpr const char* kUntakenFixes = "gnss_between_frames";

/// Whether it is a rigid motion, and not farther than this.
bool isPose(const Pose& pose, double max_distance_m) {
  const Eigen::Matrix3d turn = pose.linear();
  return pose.matrix().allFinite() && pose.translation().cwiseAbs().maxCoeff() <= max_distance_m &&
         (turn * turn.transpose()).isIdentity(kMaxRotationError) && turn.determinant() > 0.0;
}

/// The inertial sample transformed to the robot frame, without what is missing or not finite.
InertialSample sampleFrom(const mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  const Pose T_robot_sensor = fromMrpt(imu.sensorPose);
  if (!isPose(T_robot_sensor, kMaxSensorOffsetM)) return {timeFrom(imu.timestamp), {}, {}};
  const Eigen::Matrix3d R_robot_sensor = T_robot_sensor.linear();
  const auto vector = [&](TIMUDataIndex x, TIMUDataIndex y,
                          TIMUDataIndex z) -> std::optional<Eigen::Vector3d> {
    if (!imu.has(x) || !imu.has(y) || !imu.has(z)) return std::nullopt;
    const Eigen::Vector3d value(imu.get(x), imu.get(y), imu.get(z));
    if (!(value.cwiseAbs().maxCoeff() <= kMaxInertialValue)) return std::nullopt;
    return Eigen::Vector3d(R_robot_sensor * value);
  };
  return {timeFrom(imu.timestamp), vector(IMU_WX, IMU_WY, IMU_WZ),
          vector(IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC)};
}

/// Ends of the beams with a valid range, in the laser's frame.
std::vector<Eigen::Vector2f> beamEnds(const mrpt::obs::CObservation2DRangeScan& scan) {
  std::vector<Eigen::Vector2f> ends;
  const std::size_t count = scan.getScanSize();
  if (!std::isfinite(scan.aperture) || count < 2) return ends;
  const float step = scan.aperture / static_cast<float>(count - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const float range = scan.getScanRange(i);
    // A range at the limit is recorded by some drivers where nothing was met.
    if (!scan.getScanRangeValidity(i) || !(range > 0.0F) || !(range < scan.maxRange) ||
        range > kMaxLaserRangeM) {
      continue;
    }
    const float from_right = static_cast<float>(i) * step - 0.5F * scan.aperture;
    const float angle = scan.rightToLeft ? from_right : -from_right;
    ends.emplace_back(range * std::cos(angle), range * std::sin(angle));
  }
  return ends;
}

}  // namespace

void FrameCollector::add(const CObservation::Ptr& observation, double arrival_s) {
  compareClocks(*observation);
  if (pairing_.accepts(*observation)) {
    if (auto pair = pairing_.add(observation)) addPair(std::move(*pair), arrival_s);
  } else if (isRecordedDetections(*observation)) {
    const auto& recorded = dynamic_cast<const CObservationObjectDetections&>(*observation);
    if (isPose(fromMrpt(recorded.sensor_pose), kMaxSensorOffsetM)) {
      assembler_.addDetections(detectionsFrom(recorded, skipped_));
    } else {
      ++skipped_["bad_detections_pose"];
    }
  } else if (isRecordedPose(*observation)) {
    const auto& recorded = dynamic_cast<const mrpt::obs::CObservationRobotPose&>(*observation);
    addPose(timeFrom(recorded.timestamp), fromMrpt(recorded.pose.mean), arrival_s);
  } else if (isMotion(*observation) && has_camera_) {
    addMotion(*observation);
  } else if (isLaser(*observation) && has_camera_) {
    addLaser(dynamic_cast<const mrpt::obs::CObservation2DRangeScan&>(*observation));
  } else if (isGnss(*observation)) {
    const auto& recorded = dynamic_cast<const mrpt::obs::CObservationGPS&>(*observation);
    if (const auto fix = fixFrom(recorded, skipped_)) fixes_.push_back(*fix);
    limitFixes(kMaxFixes);
  } else {
    ++skipped_[shortClassName(*observation)];
  }
}

std::vector<GnssFix> FrameCollector::takeFixes(Time until) {
  std::vector<GnssFix> taken;
  const auto is_later = [until](const GnssFix& fix) { return fix.time > until; };
  const auto end = std::stable_partition(fixes_.begin(), fixes_.end(),
                                         [&](const GnssFix& fix) { return !is_later(fix); });
  taken.assign(fixes_.begin(), end);
  fixes_.erase(fixes_.begin(), end);
  return taken;
}

void FrameCollector::limitFixes(std::size_t max_count) {
  while (fixes_.size() > max_count) {
    fixes_.pop_front();
    ++skipped_[kUntakenFixes];
  }
}

void FrameCollector::compareClocks(const CObservation& observation) {
  const Time time = timeFrom(observation.timestamp);
  if (isImage(observation) && observation.sensorLabel == left_label_) {
    clocks_.addImage(assembler_.nextIndex(), time, warnings_);
  } else if (!isImage(observation) || pairing_.accepts(observation)) {
    const auto& label = observation.sensorLabel;
    clocks_.addSample(label.empty() ? shortClassName(observation) : label, time);
  }
}

void FrameCollector::finish() {
  pairing_.finish();
  assembler_.finish();
  if (!fixes_.empty() && assembler_.frames() == 0) {
    skipped_[kUntakenFixes] += fixes_.size();
    fixes_.clear();
  }
}

void FrameCollector::addPair(RecordedPair pair, double arrival_s) {
  PendingFrame frame;
  frame.arrival_s = arrival_s;
  frame.time = pair.time;
  frame.pair = std::move(pair);
  // Samples of the time before do not continue those of a clock that was set back.
  if (assembler_.addFrame(std::move(frame))) prior_ = MotionPriorBuilder();
}

void FrameCollector::addPose(Time time, const Pose& T_map_robot, double arrival_s) {
  if (!isPose(T_map_robot, kMaxPositionM)) {
    ++skipped_["bad_pose"];
  } else if (!isReachable(time, T_map_robot)) {
    ++skipped_["pose_jump"];
  } else if (has_camera_) {
    assembler_.addPose(time, T_map_robot);
  } else {
    PendingFrame frame;
    frame.arrival_s = arrival_s;
    frame.time = time;
    frame.T_map_robot = T_map_robot;
    (void)assembler_.addFrame(std::move(frame));
  }
}

/// Whether the robot can have moved there from the last recorded pose. A second pose there shows
/// that the map has changed.
bool FrameCollector::isReachable(Time time, const Pose& T_map_robot) {
  const auto from = [&](const std::optional<Stamped<Pose>>& pose) {
    if (!pose) return false;
    const double distance = (T_map_robot.translation() - pose->value.translation()).norm();
    return distance < kMaxPoseJumpM + kMaxSpeed * std::abs(time - pose->time);
  };
  const bool is_reachable = !last_pose_ || from(last_pose_) || from(distant_pose_);
  distant_pose_.reset();
  (is_reachable ? last_pose_ : distant_pose_) = Stamped<Pose>{time, T_map_robot};
  return is_reachable;
}

void FrameCollector::addMotion(const CObservation& observation) {
  if (const auto* imu = dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation)) {
    const InertialSample sample = sampleFrom(*imu);
    if (sample.angular_velocity || sample.acceleration) {
      prior_.addInertial(sample);
    } else {
      ++skipped_["bad_imu"];
    }
    return;
  }
  const auto& odometry = dynamic_cast<const mrpt::obs::CObservationOdometry&>(observation);
  const Pose T_odom_robot = fromMrpt(mrpt::poses::CPose3D(odometry.odometry));
  if (isPose(T_odom_robot, kMaxPositionM)) {
    prior_.addOdometry(timeFrom(odometry.timestamp), T_odom_robot);
  } else {
    ++skipped_["bad_odometry"];
  }
}

void FrameCollector::addLaser(const mrpt::obs::CObservation2DRangeScan& observation) {
  LaserScan scan;
  scan.label = observation.sensorLabel;
  scan.time = timeFrom(observation.timestamp);
  scan.T_robot_laser = fromMrpt(observation.sensorPose);
  if (observation.stdError > 0.0F) scan.sigma_m = static_cast<double>(observation.stdError);
  scan.ends = beamEnds(observation);
  if (!isPose(scan.T_robot_laser, kMaxSensorOffsetM)) {
    ++skipped_["laser_bad_pose"];
  } else if (scan.ends.empty()) {
    ++skipped_["laser_no_ranges"];
  } else {
    assembler_.addLaserScan(std::move(scan));
  }
}

}  // namespace headway::io
