#include "frame_collector.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservationRobotPose.h>

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

}  // namespace headway::io
