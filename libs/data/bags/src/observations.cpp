// SPDX-License-Identifier: BSD-3-Clause
#include "observations.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/gnss_accuracy.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/observation_calibration.h>

#include <algorithm>
#include <cmath>

namespace headway::bags {
namespace {

constexpr double kScanSigmaM = 0.01;  // LaserScan states none; MRPT's default
constexpr std::size_t kMaxBeams = 100000;

/// NMEA's quality of a fix of NavSatStatus: none, plain, satellite-based, ground-based corrections.
std::uint8_t qualityOf(int status) {
  if (status < 0) return 0;
  if (status == 0) return 1;
  return status == 1 ? 2 : 4;
}

}  // namespace

mrpt::obs::CObservationIMU::Ptr imuObservation(const ImuMessage& message, Time time,
                                               const Pose& T_robot_imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  auto observation = CObservationIMU::Create();
  observation->timestamp = io::mrptTime(time);
  observation->sensorLabel = "imu";
  const Eigen::Vector3d rate = T_robot_imu.linear() * message.angular_velocity;
  const Eigen::Vector3d acceleration = T_robot_imu.linear() * message.acceleration;
  if (message.has_angular_velocity) {
    observation->set(IMU_WX, rate.x());
    observation->set(IMU_WY, rate.y());
    observation->set(IMU_WZ, rate.z());
  }
  if (message.has_acceleration) {
    observation->set(IMU_X_ACC, acceleration.x());
    observation->set(IMU_Y_ACC, acceleration.y());
    observation->set(IMU_Z_ACC, acceleration.z());
  }
  return observation;
}

mrpt::obs::CObservationGPS::Ptr gnssObservation(const NavSatFixMessage& message, Time time,
                                                const Pose& T_robot_antenna) {
  auto observation = mrpt::obs::CObservationGPS::Create();
  observation->timestamp = io::mrptTime(time);
  observation->sensorLabel = "gnss";
  observation->sensorPose = toMrpt(T_robot_antenna);
  mrpt::obs::gnss::Message_NMEA_GGA position;
  position.fields.latitude_degrees = message.latitude_deg;
  position.fields.longitude_degrees = message.longitude_deg;
  position.fields.altitude_meters = message.altitude_m;
  std::uint8_t quality = qualityOf(message.status);
  // Some drivers give the best status to what their covariance calls bad.
  if (quality > 1 && !io::gnssSigma(quality, io::hdopOf(quality, message.sigma_m))) quality = 1;
  position.fields.fix_quality = quality;
  if (const auto hdop = io::hdopOf(quality, message.sigma_m); hdop > 0.0) {
    position.fields.thereis_HDOP = true;
    position.fields.HDOP = static_cast<float>(*hdop);
  }
  observation->setMsg(position);
  return observation;
}

std::optional<io::RecordedScan> scanFrom(const LaserScanMessage& message, Time time,
                                         const Pose& T_robot_laser) {
  const double step = message.angle_increment;
  const auto beams = message.ranges.size();
  if (beams < 2 || beams > kMaxBeams || !std::isfinite(message.angle_min) || !std::isfinite(step) ||
      step == 0.0 || !(message.range_max > 0.0F)) {
    return std::nullopt;
  }
  const double aperture = std::abs(step) * static_cast<double>(beams - 1);
  if (aperture > 2.1 * M_PI) return std::nullopt;
  io::RecordedScan scan;
  scan.time = time;
  scan.aperture_rad = aperture;
  scan.max_range_m = message.range_max;
  scan.sigma_m = kScanSigmaM;
  for (const float range : message.ranges) {
    const bool is_measured = range >= message.range_min && range <= message.range_max;
    scan.ranges.push_back(is_measured ? range : 0.0F);
  }
  if (step < 0.0) std::reverse(scan.ranges.begin(), scan.ranges.end());
  const double middle = message.angle_min + 0.5 * step * static_cast<double>(beams - 1);
  scan.T_robot_laser = T_robot_laser * Eigen::AngleAxisd(middle, Eigen::Vector3d::UnitZ());
  return scan;
}

mrpt::obs::CObservation3DRangeScan::Ptr depthObservation(const cv::Mat& picture,
                                                         const cv::Mat& depth, Time time,
                                                         const BagRig& rig) {
  io::RawDepthCamera camera;
  camera.color = rig.color;
  camera.depth = rig.depth;
  camera.T_robot_color = rig.T_robot_color;
  camera.T_color_depth = rig.T_robot_color.inverse() * rig.T_robot_depth;
  auto observation =
      io::depthObservation(mrpt::img::CImage(picture, mrpt::img::SHALLOW_COPY), depth, camera);
  observation->timestamp = io::mrptTime(time);
  observation->sensorLabel = "rgbd";
  return observation;
}

}  // namespace headway::bags
