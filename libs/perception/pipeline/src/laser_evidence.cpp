// SPDX-License-Identifier: BSD-3-Clause
// Ends of laser beams as obstacles of a ground scan.
#include "laser_evidence.h"

#include <headway/stereo/ground_plane.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace headway::pipeline {
namespace {

constexpr double kLevelM = 0.1;           // change of height along a level beam
constexpr double kMinSigmaM = 0.02;       // of an end, with the error of the robot's motion
constexpr double kSigmas = 3.0;           // before an end, the beam has passed nothing
constexpr double kTrackMarginM = 0.25;    // around the box of a moving track
constexpr double kTrackSigmas = 2.0;      // of its position
constexpr std::size_t kDirections = 720;  // in which free ground is limited

/// The robot at the time of a scan in its frame at the time of the image, with constant velocity.
Pose motionTo(Time time, const LaserScene& scene) {
  if (!scene.T_previous_robot || !(scene.interval_s > 0.0)) return Pose::Identity();
  const double ratio = (time - scene.time) / scene.interval_s;
  const Pose& step = *scene.T_previous_robot;
  Pose motion = Pose::Identity();
  motion.linear() = expSo3(ratio * logSo3(step.linear()));
  motion.translation() = ratio * (step.linear().transpose() * step.translation());
  return motion;
}

bool mayMove(const Track& track) {
  return track.status != TrackStatus::kEnded && track.motion_state != MotionState::kStatic;
}

/// Boxes of objects that may move, at the time of a scan, from above.
class MovingBoxes {
 public:
  MovingBoxes(const std::vector<Track>& tracks, double later_s) {
    for (const auto& track : tracks) {
      if (!mayMove(track)) continue;
      const double sigma = std::sqrt(std::max(track.position_covariance(0, 0),  //
                                              track.position_covariance(1, 1)));
      const double margin = kTrackMarginM + std::min(kTrackSigmas * sigma, kTrackMarginM);
      boxes_.push_back({(track.position + later_s * track.velocity).head<2>(),
                        {std::cos(track.yaw), std::sin(track.yaw)},
                        0.5 * track.size.head<2>().array() + margin});
    }
  }
  [[nodiscard]] bool contain(const Eigen::Vector3d& place) const {
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const Box& box) {
      const Eigen::Vector2d offset = place.head<2>() - box.centre;
      const double along = box.front.dot(offset);
      const double across = box.front.x() * offset.y() - box.front.y() * offset.x();
      return std::abs(along) <= box.half.x() && std::abs(across) <= box.half.y();
    });
  }

 private:
  struct Box {
    Eigen::Vector2d centre, front, half;
  };
  std::vector<Box> boxes_;
};

/// Sorts the ends of one scan's beams.
class BeamSorter {
 public:
  BeamSorter(const LaserScene& scene, const LaserParams& params, GroundScan& scan,
             std::map<std::string, std::size_t>& counts)
      : scene_(scene), params_(params), scan_(scan), counts_(counts) {}

  void sort(const LaserScan& laser, const std::vector<Track>& tracks) {
    const Pose T_robot_laser = motionTo(laser.time, scene_) * laser.T_robot_laser;
    const MovingBoxes moving(tracks, laser.time - scene_.time);
    const auto sigma = static_cast<float>(std::max(laser.sigma_m, kMinSigmaM));
    const Eigen::Vector3d origin = T_robot_laser.translation();
    for (const Eigen::Vector2f& end : laser.ends) {
      const auto range = static_cast<double>(end.norm());
      if (range > params_.reach_m) {
        ++counts_["beyond_reach"];
        continue;
      }
      const Eigen::Vector3d place =
          T_robot_laser * Eigen::Vector3d(end.cast<double>().x(), end.cast<double>().y(), 0.0);
      const EndKind kind = kindOf(place, moving);
      ++counts_[toString(kind)];
      if (kind == EndKind::kObstacle) scan_.laser_obstacles.push_back({footOf(place), sigma});
      const double ratio = 1.0 - kSigmas * static_cast<double>(sigma) / range;
      pass(origin, origin + std::max(0.0, ratio) * (place - origin), range);
    }
    for (const auto& [direction, beam] : passed_) {
      scan_.laser_passed.push_back({footOf(origin), footOf(beam.second)});
    }
    passed_.clear();
  }

 private:
  enum class EndKind { kObstacle, kOnMovingObject, kOnGround, kAboveRobot, kOnRobot };

  /// Name under which they are counted.
  static const char* toString(EndKind kind) {
    constexpr const char* kNames[] = {"obstacles", "on_moving_objects", "on_ground", "above_robot",
                                      "on_robot"};
    return kNames[static_cast<std::size_t>(kind)];
  }

  [[nodiscard]] EndKind kindOf(const Eigen::Vector3d& place, const MovingBoxes& moving) const {
    const double height = scene_.ground.heightOf(place);
    if (height < stereo::kGroundRatio * scene_.min_obstacle_height_m) return EndKind::kOnGround;
    if (height > scene_.max_obstacle_height_m) return EndKind::kAboveRobot;
    const auto& footprint = scene_.footprint;
    if (std::abs(place.x()) < 0.5 * footprint.length_m &&
        std::abs(place.y()) < 0.5 * footprint.width_m) {
      return EndKind::kOnRobot;
    }
    const bool on_moving = moving.contain(scene_.T_odom_robot * place);
    return on_moving ? EndKind::kOnMovingObject : EndKind::kObstacle;
  }

  /// Stores the shortest beam of each degree if it is level and where obstacles stand.
  void pass(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double range) {
    const double height = scene_.ground.heightOf(from);
    const double end = scene_.ground.heightOf(to);
    const double lowest = stereo::kGroundRatio * scene_.min_obstacle_height_m;
    if (std::abs(end - height) > kLevelM || std::min(height, end) < lowest) return;
    if (std::max(height, end) > scene_.max_obstacle_height_m) return;
    const int direction =
        static_cast<int>(std::floor(std::atan2(to.y() - from.y(), to.x() - from.x()) / kDegree));
    const auto [beam, is_new] = passed_.try_emplace(direction, range, to);
    if (!is_new && range < beam->second.first) beam->second = {range, to};
  }

  [[nodiscard]] Eigen::Vector3f footOf(const Eigen::Vector3d& place) const {
    return (place - scene_.ground.heightOf(place) * scene_.ground.up).cast<float>();
  }

  const LaserScene& scene_;
  const LaserParams& params_;
  GroundScan& scan_;
  std::map<std::string, std::size_t>& counts_;
  std::map<int, std::pair<double, Eigen::Vector3d>> passed_;  ///< by direction
};

/// Ends the free ground of stereo at the nearest obstacle of a laser in its direction.
void limitFreeGround(const Eigen::Vector3d& camera, GroundScan& scan) {
  std::array<double, kDirections> limits{};
  limits.fill(std::numeric_limits<double>::infinity());
  const auto offsetOf = [&](const Eigen::Vector3f& place) -> Eigen::Vector2d {
    return place.head<2>().cast<double>() - camera.head<2>();
  };
  const auto directionOf = [](const Eigen::Vector2d& offset) {
    const double turn = std::atan2(offset.y(), offset.x()) / (2.0 * M_PI) + 0.5;
    return static_cast<std::size_t>(turn * static_cast<double>(kDirections)) % kDirections;
  };
  for (const auto& obstacle : scan.laser_obstacles) {
    const Eigen::Vector2d offset = offsetOf(obstacle.foot);
    const std::size_t direction = directionOf(offset);
    for (const std::size_t near : {kDirections - 1, kDirections, kDirections + 1}) {
      double& limit = limits[(direction + near) % kDirections];
      limit = std::min(limit, offset.norm());
    }
  }
  const auto is_hidden = [&](GroundScan::Free& piece) {
    const Eigen::Vector2d from = offsetOf(piece.from);
    const Eigen::Vector2d to = offsetOf(piece.to);
    const double limit = limits[directionOf(to)];
    if (to.norm() <= limit) return false;
    if (from.norm() >= limit) return true;
    const double ratio = (limit - from.norm()) / (to.norm() - from.norm());
    piece.to = piece.from + static_cast<float>(ratio) * (piece.to - piece.from);
    return false;
  };
  scan.free.erase(std::remove_if(scan.free.begin(), scan.free.end(), is_hidden), scan.free.end());
}

}  // namespace

void addLaserScans(const std::vector<LaserScan>& scans, const LaserScene& scene,
                   const std::vector<Track>& tracks, const LaserParams& params, GroundScan& scan,
                   std::map<std::string, std::size_t>& counts) {
  BeamSorter sorter(scene, params, scan, counts);
  for (const auto& laser : scans) {
    sorter.sort(laser, tracks);
    ++counts["used"];
  }
  limitFreeGround(scene.camera, scan);
}

}  // namespace headway::pipeline
