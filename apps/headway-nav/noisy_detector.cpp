#include "noisy_detector.h"

#include <cmath>

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr double kPersonHeight_m = 1.7;
constexpr double kDegree = M_PI / 180.0;

/// Whether a disc lies across the sight from the robot to a place, both in the robot's frame.
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

bool isHidden(const Crowd& crowd, const mrpt::math::TPose2D& robot, const Person& person) {
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

NoisyDetector::NoisyDetector(const SensorParams& params, std::uint64_t seed)
    : params_(params),
      random_(seed),
      T_robot_sensor_(Eigen::Translation3d(-params.detection_range_m - 1.0, 0.0, 0.0) *
                      robotFromOptical()) {}

Detections NoisyDetector::detect(const Crowd& crowd, const mrpt::math::TPose2D& robot, Time time) {
  Detections detections;
  detections.time = time;
  detections.T_robot_sensor = T_robot_sensor_;
  for (const auto& person : crowd.people()) {
    const Vector2d place = toRobot(robot, person.position);
    if (place.norm() > params_.detection_range_m || place.norm() < 0.1) continue;
    const double bearing_deg = std::abs(std::atan2(place.y(), place.x())) / kDegree;
    if (bearing_deg > 0.5 * params_.field_of_view_deg) continue;
    if (isHidden(crowd, robot, person) || happens(params_.miss_share)) continue;
    const Vector2d velocity = person.velocity();
    const double heading = std::atan2(velocity.y(), velocity.x()) - robot.phi;
    detections.items.push_back(boxOf(blurred(place), heading, person.radius));
    if (!happens(params_.double_share)) continue;
    const Vector2d twin = place + Vector2d(normal(0.5), normal(0.5));
    detections.items.push_back(boxOf(twin, heading, person.radius));
  }
  if (happens(params_.false_share)) {
    std::uniform_real_distribution<double> angle(-M_PI, M_PI);
    std::uniform_real_distribution<double> range(1.0, params_.detection_range_m);
    const Vector2d place = Eigen::Rotation2Dd(angle(random_)) * Vector2d(range(random_), 0.0);
    detections.items.push_back(boxOf(place, angle(random_), 0.25));
  }
  return detections;
}

Vector2d NoisyDetector::blurred(const Vector2d& place) {
  const double distance = place.norm();
  const double along = params_.along_sigma_m + params_.along_sigma_per_m * distance;
  const Vector2d ray = place / distance;
  const Vector2d across(-ray.y(), ray.x());
  return place + normal(along) * ray + normal(params_.across_share * along) * across;
}

/// What the detector knows of its own noise, in the sensor's frame.
Eigen::Matrix3d NoisyDetector::covarianceAt(const Vector2d& place) const {
  const double along = params_.along_sigma_m + params_.along_sigma_per_m * place.norm();
  const double across = params_.across_share * along;
  const Eigen::Vector3d ray = Eigen::Vector3d(place.x(), place.y(), 0.0).normalized();
  const Eigen::Matrix3d covariance = across * across * Eigen::Matrix3d::Identity() +
                                     (along * along - across * across) * ray * ray.transpose();
  const Eigen::Matrix3d R_sensor_robot = T_robot_sensor_.linear().transpose();
  return R_sensor_robot * covariance * R_sensor_robot.transpose();
}

Detection NoisyDetector::boxOf(const Vector2d& place, double heading, double radius) {
  heading += normal(params_.yaw_sigma_deg * kDegree);
  if (happens(params_.flip_share)) heading += M_PI;
  const Eigen::Vector3d centre(place.x(), place.y(), 0.5 * kPersonHeight_m);
  Eigen::Vector3d size;
  size.x() = std::max(0.2, 2.0 * radius + normal(params_.size_sigma_m));
  size.y() = std::max(0.2, 2.0 * radius + normal(params_.size_sigma_m));
  size.z() = kPersonHeight_m + normal(params_.size_sigma_m);
  Detection detection;
  detection.object_class = ObjectClass::kPedestrian;
  detection.box3d = opticalBox(centre, size, heading, T_robot_sensor_.inverse());
  detection.centre_covariance = covarianceAt(place);
  return detection;
}

bool NoisyDetector::happens(double share) {
  return std::uniform_real_distribution<double>(0.0, 1.0)(random_) < share;
}

double NoisyDetector::normal(double sigma) {
  return sigma * std::normal_distribution<double>(0.0, 1.0)(random_);
}

Pose poseOf(const mrpt::math::TPose2D& pose) {
  return Eigen::Translation3d(pose.x, pose.y, 0.0) *
         Eigen::AngleAxisd(pose.phi, Eigen::Vector3d::UnitZ());
}

}  // namespace headway::app
