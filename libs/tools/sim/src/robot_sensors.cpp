// SPDX-License-Identifier: BSD-3-Clause
// Sensors of the robot other than cameras: laser scanner, inertial sensor, wheels, satellite
// receiver.
#include "robot_sensors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace headway::sim {

LaserScanner::LaserScanner(const LaserParams& params, std::uint64_t seed)
    : params_(params), random_(seed) {
  T_robot_laser_.translation() = Eigen::Vector3d(params.forward_m, 0.0, params.height_m);
}

void LaserScanner::addSegment(const Eigen::Vector2d& a, const Eigen::Vector2d& b,
                              std::vector<double>& ranges) const {
  const double aperture = params_.aperture_deg * M_PI / 180.0;
  const auto last = static_cast<double>(ranges.size() - 1);
  const double step = aperture / last;
  double from = std::atan2(a.y(), a.x()), to = std::atan2(b.y(), b.x());
  if (std::abs(from - to) > M_PI) (from < to ? from : to) += 2.0 * M_PI;  // across the back
  if (from > to) std::swap(from, to);
  const Eigen::Vector2d along = b - a;
  for (const double turn : {0.0, -2.0 * M_PI}) {
    const double first_ray = std::ceil((from + turn + 0.5 * aperture) / step);
    const double last_ray = std::floor((to + turn + 0.5 * aperture) / step);
    for (double i = std::max(0.0, first_ray); i <= std::min(last, last_ray); i += 1.0) {
      const double angle = i * step - 0.5 * aperture;
      const Eigen::Vector2d ray(std::cos(angle), std::sin(angle));
      const double across = ray.x() * along.y() - ray.y() * along.x();
      if (std::abs(across) < 1e-12) continue;
      const double range = (a.x() * along.y() - a.y() * along.x()) / across;
      double& nearest = ranges[static_cast<std::size_t>(i)];
      if (range > 0.0) nearest = std::min(nearest, range);
    }
  }
}

void LaserScanner::cut(const std::array<Eigen::Vector3d, 3>& triangle,
                       std::vector<double>& ranges) const {
  std::array<Eigen::Vector2d, 2> ends;
  std::size_t count = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Eigen::Vector3d &p = triangle[i], &q = triangle[(i + 1) % 3];
    if ((p.z() > 0.0) == (q.z() > 0.0)) continue;
    const double ratio = p.z() / (p.z() - q.z());
    ends[count++] = (p + ratio * (q - p)).head<2>();
  }
  if (count == 2) addSegment(ends[0], ends[1], ranges);
}

io::RecordedScan LaserScanner::scan(Time time, const Pose& T_world_robot,
                             const std::vector<PlacedMesh>& statics,
                             const std::vector<Mesh>& actor_meshes) {
  const Pose T_laser_world = (T_world_robot * T_robot_laser_).inverse();
  std::vector<double> ranges(static_cast<std::size_t>(params_.rays),
                             std::numeric_limits<double>::infinity());
  const auto add = [&](const Mesh& mesh, const Eigen::Vector3d& anchor) {
    const Pose T_laser_mesh = T_laser_world * Eigen::Translation3d(anchor);
    for (const auto& triangle : mesh.triangles) {
      cut({T_laser_mesh * triangle[0].position.cast<double>(),
           T_laser_mesh * triangle[1].position.cast<double>(),
           T_laser_mesh * triangle[2].position.cast<double>()},
          ranges);
    }
  };
  for (const PlacedMesh& placed : statics) add(*placed.mesh, placed.anchor);
  for (const Mesh& mesh : actor_meshes) add(mesh, T_world_robot.translation());
  io::RecordedScan scan;
  scan.time = time;
  scan.T_robot_laser = T_robot_laser_;
  scan.aperture_rad = params_.aperture_deg * M_PI / 180.0;
  scan.max_range_m = params_.max_range_m;
  scan.sigma_m = params_.sigma_m;
  for (const double range : ranges) {
    const double measured = range + params_.sigma_m * random_.normal();
    const bool lost = random_.chance(params_.miss_ratio);
    const bool valid = !lost && range >= params_.min_range_m && measured < params_.max_range_m;
    scan.ranges.push_back(valid ? static_cast<float>(measured) : 0.0F);
  }
  return scan;
}

namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

/// Standard deviations of the errors of a small MEMS sensor and of a car's wheel encoders.
struct MotionNoise {
  double gyro_rps = 0.002, gyro_bias_rps = 0.003;
  double accelerometer_mps2 = 0.05, accelerometer_bias_mps2 = 0.08;
  double wheel_scale = 0.005;
  double heading = 0.0032;        ///< [rad/sqrt(m)], 0.01 rad after 10 m
  double slip_period_s = 2.0;     ///< slipping begins anew each time
  double slip_speed_ratio = 2.0;  ///< of slipping wheels to the robot
};
constexpr MotionNoise kNoise{};

}  // namespace

MotionSensors::MotionSensors(std::uint64_t seed, double slip_ratio)
    : random_(seed), slip_ratio_(slip_ratio) {
  gyro_bias_ = noise(kNoise.gyro_bias_rps);
  accelerometer_bias_ = noise(kNoise.accelerometer_bias_mps2);
  wheel_scale_ = 1.0 + kNoise.wheel_scale * random_.normal();
}

Eigen::Vector3d MotionSensors::noise(double sigma) {
  const double x = random_.normal(), y = random_.normal(), z = random_.normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

void MotionSensors::integrateWheels(Time time, const Pose& T_previous_now) {
  const bool slips =
      std::fmod(time, kNoise.slip_period_s) >= (1.0 - slip_ratio_) * kNoise.slip_period_s;
  const double way =
      T_previous_now.translation().x() * wheel_scale_ * (slips ? kNoise.slip_speed_ratio : 1.0);
  const double turn =
      yawOf(T_previous_now) + kNoise.heading * std::sqrt(std::abs(way)) * random_.normal();
  odometry_->x += way * std::cos(odometry_->yaw + 0.5 * turn);
  odometry_->y += way * std::sin(odometry_->yaw + 0.5 * turn);
  odometry_->yaw = wrapAngle(odometry_->yaw + turn);
}

void MotionSensors::observe(Time time, const Pose& T_world_robot) {
  if (!odometry_) odometry_ = OdometrySample{};
  odometry_->time = time;
  if (last_) {
    const double dt = time - last_->time;
    const Pose T_previous_now = last_->value.inverse() * T_world_robot;
    integrateWheels(time, T_previous_now);
    const Step step{dt, logSo3(T_previous_now.linear()) / dt,
                    (T_world_robot.translation() - last_->value.translation()) / dt};
    if (step_) imu_.push_back(sampleBetween(*step_, step));
    step_ = step;
  }
  last_ = {time, T_world_robot};
}

ImuSample MotionSensors::sampleBetween(const Step& before, const Step& after) {
  // Central differences: what is true at the pose between the two steps, in its own axes.
  const double dt = 0.5 * (before.duration_s + after.duration_s);
  const Eigen::Vector3d force =
      (after.velocity - before.velocity) / dt + Eigen::Vector3d(0.0, 0.0, kGravity);
  ImuSample sample;
  sample.time = last_->time;
  sample.angular_velocity = 0.5 * (before.angular_velocity + after.angular_velocity) + gyro_bias_ +
                            noise(kNoise.gyro_rps);
  sample.acceleration = last_->value.linear().transpose() * force + accelerometer_bias_ +
                        noise(kNoise.accelerometer_mps2);
  return sample;
}

std::vector<ImuSample> MotionSensors::takeImu() { return std::exchange(imu_, {}); }

SatelliteReceiver::SatelliteReceiver(const GnssParams& params, std::uint64_t seed)
    : params_(params),
      random_(seed),
      frame_({params.latitude_deg, params.longitude_deg, params.altitude_m}) {
  const double yaw = (90.0 - params.heading_deg) * M_PI / 180.0;
  T_enu_world_.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

void SatelliteReceiver::observe(Time time, const Pose& T_world_robot) {
  if (!params_.enabled) return;
  if (!due_) due_ = time;
  if (time < *due_) return;
  *due_ = std::max(*due_ + 1.0 / params_.rate_hz, time);
  io::RecordedGnss fix;
  fix.time = time;
  fix.T_robot_antenna.translation() << params_.forward_m, 0.0, params_.height_m;
  Eigen::Vector3d enu = T_enu_world_ * (T_world_robot * fix.T_robot_antenna.translation());
  for (int axis = 0; axis < 3; ++axis) {
    enu[axis] += params_.sigma_m * (axis < 2 ? 1.0 : 1.7) * random_.normal();
  }
  if (random_.chance(params_.outlier_ratio)) {
    const double direction = random_.uniform(0.0, 2.0 * M_PI);
    const double distance = random_.uniform(0.0, params_.outlier_m);
    enu += distance * Eigen::Vector3d(std::cos(direction), std::sin(direction), 0.0);
  }
  const auto position = frame_.positionOf(enu);
  fix.latitude_deg = position.latitude_deg;
  fix.longitude_deg = position.longitude_deg;
  fix.altitude_m = position.altitude_m;
  fix.satellites = 9;
  fix.sigma_m = params_.sigma_m;
  fixes_.push_back(fix);
}

std::vector<io::RecordedGnss> SatelliteReceiver::take() { return std::exchange(fixes_, {}); }

TruePlace SatelliteReceiver::placeOf(Time time, const Pose& T_world_robot) const {
  const Pose T_enu_robot = T_enu_world_ * T_world_robot;
  const auto position = frame_.positionOf(T_enu_robot.translation());
  const double heading = 90.0 - yawOf(T_enu_robot) * 180.0 / M_PI;
  return {time, position.latitude_deg, position.longitude_deg, position.altitude_m,
          heading - 360.0 * std::floor(heading / 360.0)};
}

}  // namespace headway::sim
