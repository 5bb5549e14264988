#include "frame_collector.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <cmath>

#include "observation_stream.h"
#include "useful_observations.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;

/// The inertial sample transformed to the robot frame, without what is missing or not finite.
InertialSample sampleFrom(const mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  const Eigen::Matrix3d R_robot_sensor = fromMrpt(imu.sensorPose).linear();
  const auto vector = [&](TIMUDataIndex x, TIMUDataIndex y,
                          TIMUDataIndex z) -> std::optional<Eigen::Vector3d> {
    if (!imu.has(x) || !imu.has(y) || !imu.has(z)) return std::nullopt;
    const Eigen::Vector3d value(imu.get(x), imu.get(y), imu.get(z));
    if (!value.allFinite()) return std::nullopt;
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
    if (!scan.getScanRangeValidity(i) || !(range > 0.0F) || !(range < scan.maxRange)) continue;
    const float from_right = static_cast<float>(i) * step - 0.5F * scan.aperture;
    const float angle = scan.rightToLeft ? from_right : -from_right;
    ends.emplace_back(range * std::cos(angle), range * std::sin(angle));
  }
  return ends;
}

}  // namespace

void FrameCollector::add(const CObservation::Ptr& observation) {
  if (pairing_.accepts(*observation)) {
    if (auto pair = pairing_.add(observation)) addPair(std::move(*pair));
  } else if (isRecordedDetections(*observation)) {
    const auto& recorded = dynamic_cast<const CObservationObjectDetections&>(*observation);
    assembler_.addDetections(detectionsFrom(recorded, skipped_));
  } else if (isRecordedPose(*observation)) {
    const auto& recorded = dynamic_cast<const mrpt::obs::CObservationRobotPose&>(*observation);
    addPose(timeFrom(recorded.timestamp), fromMrpt(recorded.pose.mean));
  } else if (isMotion(*observation) && has_camera_) {
    addMotion(*observation);
  } else if (isLaser(*observation) && has_camera_) {
    addLaser(dynamic_cast<const mrpt::obs::CObservation2DRangeScan&>(*observation));
  } else {
    ++skipped_[shortClassName(*observation)];
  }
}

void FrameCollector::finish() {
  pairing_.finish();
  assembler_.finish();
}

void FrameCollector::addPair(RecordedPair pair) {
  PendingFrame frame;
  frame.time = pair.time;
  frame.pair = std::move(pair);
  assembler_.addFrame(std::move(frame));
}

void FrameCollector::addPose(Time time, const Pose& T_map_robot) {
  if (!T_map_robot.matrix().allFinite()) {
    ++skipped_["bad_pose"];
  } else if (has_camera_) {
    assembler_.addPose(time, T_map_robot);
  } else {
    PendingFrame frame;
    frame.time = time;
    frame.T_map_robot = T_map_robot;
    assembler_.addFrame(std::move(frame));
  }
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
  if (T_odom_robot.matrix().allFinite()) {
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
  if (!scan.T_robot_laser.matrix().allFinite()) {
    ++skipped_["laser_bad_pose"];
  } else if (scan.ends.empty()) {
    ++skipped_["laser_no_ranges"];
  } else {
    assembler_.addLaserScan(std::move(scan));
  }
}

}  // namespace headway::io
