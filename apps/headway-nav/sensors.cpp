// SPDX-License-Identifier: BSD-3-Clause
// Simulated sensors of a trial: a range scanner and a detector of people.
#include "sensors.h"

#include <headway/core/pose.h>

#include <cmath>
#include <limits>

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr int kRays = 360;

/// Range at which a ray from the origin meets a disc; infinity if it does not.
double rangeToDisc(const Vector2d& ray, const Vector2d& centre, double radius) {
  const double along = ray.dot(centre);
  const double squared = radius * radius - (centre.squaredNorm() - along * along);
  if (squared < 0.0 || along < 0.0) return std::numeric_limits<double>::infinity();
  return std::max(0.0, along - std::sqrt(squared));
}

constexpr double kPersonHeight_m = 1.7;

/// Whether a disc occludes a position from the robot, both in the robot's frame.
bool hides(const Vector2d& disc, double radius, const Vector2d& place) {
  const double distance = place.norm();
  const Vector2d ray = place / distance;
  const double along = ray.dot(disc);
  if (along <= 0.0 || along >= distance - radius) return false;
  return (disc - along * ray).norm() < radius;
}

Vector2d toRobot(const mrpt::math::TPose2D& robot, const Vector2d& place) {
  return Eigen::Rotation2Dd(-robot.phi) * (place - Vector2d(robot.x, robot.y));
}

bool isHidden(const sim::Crowd& crowd, const mrpt::math::TPose2D& robot,
              const sim::Person& person) {
  const Vector2d place = toRobot(robot, person.position);
  for (const auto& other : crowd.people()) {
    if (&other != &person && hides(toRobot(robot, other.position), other.radius, place)) {
      return true;
    }
  }
  for (const auto& pillar : crowd.pillars()) {
    if (hides(toRobot(robot, pillar.position), pillar.radius, place)) return true;
  }
  return false;
}

}  // namespace

RangeScanner::RangeScanner(const SensorParams& params, std::uint64_t seed)
    : params_(params), random_(seed) {}

void RangeScanner::scan(const sim::Crowd& crowd, const mrpt::math::TPose2D& robot,
                        mrpt::maps::CSimplePointsMap& out) {
  std::normal_distribution<double> noise(0.0, 1.0);
  const Vector2d here(robot.x, robot.y);
  out.clear();
  for (int i = 0; i < kRays; ++i) {
    const double angle = 2.0 * M_PI * i / kRays;
    const Vector2d ray(std::cos(robot.phi + angle), std::sin(robot.phi + angle));
    double range = std::numeric_limits<double>::infinity();
    for (const auto& person : crowd.people()) {
      range = std::min(range, rangeToDisc(ray, person.position - here, person.radius));
    }
    for (const auto& pillar : crowd.pillars()) {
      range = std::min(range, rangeToDisc(ray, pillar.position - here, pillar.radius));
    }
    const double measured = range + params_.scan_sigma_m * noise(random_);
    if (range > params_.scan_range_m) continue;
    out.insertPoint(static_cast<float>(measured * std::cos(angle)),
                    static_cast<float>(measured * std::sin(angle)), 0.4F);
  }
}

NoisyDetector::NoisyDetector(const SensorParams& params, std::uint64_t seed)
    : params_(params),
      random_(seed),
      T_robot_sensor_(Eigen::Translation3d(-params.detection_range_m - 1.0, 0.0, 0.0) *
                      robotFromOptical()) {}

Detections NoisyDetector::detect(const sim::Crowd& crowd, const mrpt::math::TPose2D& robot,
                                 Time time) {
  Detections detections;
  detections.time = time;
  detections.T_robot_sensor = T_robot_sensor_;
  for (const auto& person : crowd.people()) {
    const Vector2d place = toRobot(robot, person.position);
    if (place.norm() > params_.detection_range_m || place.norm() < 0.1) continue;
    const double bearing_deg = std::abs(std::atan2(place.y(), place.x())) / kDegree;
    if (bearing_deg > 0.5 * params_.field_of_view_deg) continue;
    if (isHidden(crowd, robot, person) || random_.chance(params_.miss_probability)) continue;
    const Vector2d velocity = person.velocity();
    const double heading = std::atan2(velocity.y(), velocity.x()) - robot.phi;
    detections.items.push_back(measured(place, heading, person.radius));
    if (!random_.chance(params_.duplicate_probability)) continue;
    const double ahead = random_.normal(), lateral = random_.normal();  // of 0.5 m each
    const Vector2d elsewhere = place + 0.5 * Vector2d(ahead, lateral);
    detections.items.push_back(measured(elsewhere, heading, person.radius));
  }
  if (random_.chance(params_.false_alarm_probability)) {
    const double bearing = random_.uniform(-M_PI, M_PI);
    const double range = random_.uniform(1.0, params_.detection_range_m);
    const Vector2d place = Eigen::Rotation2Dd(bearing) * Vector2d(range, 0.0);
    detections.items.push_back(measured(place, random_.uniform(-M_PI, M_PI), 0.25));
  }
  return detections;
}

DetectorNoise NoisyDetector::noiseOf(double distance_m, double width_m) const {
  DetectorNoise noise;
  noise.along_sigma_m = params_.along_sigma_m + params_.along_sigma_per_m * distance_m;
  noise.across_sigma_m = params_.across_ratio * noise.along_sigma_m;
  noise.vertical_variance_ratio = 1.0;
  noise.size_sigma_ratio = params_.size_sigma_m / width_m;
  noise.yaw_sigma_rad = params_.yaw_sigma_deg * kDegree;
  noise.flip_probability = params_.flip_probability;
  return noise;
}

/// The box is measured by a camera on the robot that points at it, so that the noise is along and
/// across the ray from the robot.
Detection NoisyDetector::measured(const Vector2d& place, double heading, double radius) {
  const Pose T_robot_camera =
      Eigen::Translation3d(0.0, 0.0, 0.5 * kPersonHeight_m) *
      Eigen::AngleAxisd(std::atan2(place.y(), place.x()), Eigen::Vector3d::UnitZ()) *
      robotFromOptical();
  const Eigen::Vector3d centre(place.x(), place.y(), 0.5 * kPersonHeight_m);
  const Eigen::Vector3d size(2.0 * radius, 2.0 * radius, kPersonHeight_m);
  const DetectorNoise noise = noiseOf(place.norm(), size.y());
  const Box3d truth = opticalBox(centre, size, heading, T_robot_camera.inverse());
  Detections seen;
  seen.T_robot_sensor = T_robot_camera;
  Detection& detection = seen.items.emplace_back();
  detection.object_class = ObjectClass::kPedestrian;
  detection.box3d = measuredBox(truth, noise, random_);
  detection.centre_covariance = centreCovariance(truth.centre, noise);
  return inSensorFrame(seen, T_robot_sensor_).items.front();
}

Pose poseOf(const mrpt::math::TPose2D& pose) {
  return Eigen::Translation3d(pose.x, pose.y, 0.0) *
         Eigen::AngleAxisd(pose.phi, Eigen::Vector3d::UnitZ());
}

}  // namespace headway::app
