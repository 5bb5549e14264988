// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/scene/snapshot.h>

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <random>

namespace headway::scene {

inline StereoCamera streetCamera() {
  StereoCamera camera;
  camera.width = 640;
  camera.height = 240;
  camera.fx = camera.fy = 360.0;
  camera.cx = 319.5;
  camera.cy = 119.5;
  camera.baseline_m = 0.4;
  camera.T_robot_cam = Eigen::Translation3d(0.3, 0.0, 1.4) * robotFromOptical();
  return camera;
}

/// An object that goes straight on, with two seconds of past and three of future.
inline Track streetTrack(std::int64_t id, ObjectClass object_class, const Eigen::Vector2d& at,
                         double yaw, double speed) {
  const bool vehicle = isVehicle(object_class);
  Track track;
  track.id = TrackId{id};
  track.object_class = object_class;
  track.status = TrackStatus::kConfirmed;
  track.motion_state = speed > 0.1 ? MotionState::kMoving : MotionState::kStatic;
  track.size = vehicle ? Eigen::Vector3d(4.3, 1.8, 1.5) : Eigen::Vector3d(0.7, 0.6, 1.75);
  track.position << at.x(), at.y(), 0.5 * track.size.z();
  track.yaw = yaw;
  track.velocity << speed * std::cos(yaw), speed * std::sin(yaw), 0.0;
  track.last_seen = 10.0;
  for (int i = 20; i >= 0; --i) {
    track.recent_path.push_back({static_cast<std::size_t>(100 - i), 10.0 - 0.1 * i,
                                 track.position - 0.1 * i * track.velocity, yaw});
  }
  PredictedPath path;
  for (int i = 1; i <= 30; ++i) {
    const double horizon = 0.1 * i;
    const double sigma = 0.1 + 0.25 * horizon;
    path.points.push_back({horizon, track.position + horizon * track.velocity,
                           sigma * sigma * Eigen::Matrix2d::Identity()});
  }
  track.predictions.push_back(path);
  return track;
}

/// A straight street between two rows of houses, with parked and moving cars and people.
inline map::PerceptionMap streetMap() {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> along(-20.0, 110.0), height(0.0, 9.0), share(0.0, 1.0);
  std::vector<slam::LandmarkView> landmarks;
  const auto add = [&](double x, double y, double z) {
    const auto grey = static_cast<std::uint8_t>(40 + 200 * share(random));
    landmarks.push_back(
        {LandmarkId{static_cast<std::int64_t>(landmarks.size())}, {x, y, z}, 4, grey});
  };
  for (int i = 0; i < 5000; ++i) {
    const double side = share(random) < 0.5 ? -1.0 : 1.0;
    add(along(random), side * (11.0 + 0.15 * share(random)), height(random));
    if (i % 4 == 0) add(along(random), side * 10.0 * share(random), 0.03 * share(random));
  }
  map::PerceptionMap map;
  map.update(slam::MapView{landmarks, {}});
  map.update(10.0, {streetTrack(3, ObjectClass::kCar, {14.0, 2.6}, 3.14159, 8.0),
                    streetTrack(5, ObjectClass::kCar, {22.0, -2.2}, 0.0, 9.5),
                    streetTrack(6, ObjectClass::kCar, {12.0, -6.5}, 0.0, 0.0),
                    streetTrack(8, ObjectClass::kPedestrian, {13.0, -4.6}, 1.5, 1.4),
                    streetTrack(9, ObjectClass::kPedestrian, {17.0, 7.5}, 0.2, 1.2),
                    streetTrack(11, ObjectClass::kCyclist, {20.0, 5.5}, 3.1, 4.5),
                    streetTrack(14, ObjectClass::kTruck, {45.0, 2.8}, 3.1, 6.0)});
  return map;
}

/// A stand-in for a camera image: sky above a street.
inline cv::Mat streetImage() {
  cv::Mat image(240, 640, CV_8UC3, cv::Scalar(200, 170, 140));
  cv::rectangle(image, {0, 120, 640, 120}, cv::Scalar(96, 98, 100), cv::FILLED);
  return image;
}

inline SnapshotInput streetInput(const map::PerceptionMap& map) {
  SnapshotInput input{map, 100, 10.0};
  input.camera = std::make_shared<StereoCamera>(streetCamera());
  input.image = streetImage();
  for (int i = 0; i <= 100; ++i) {
    Pose pose = Pose::Identity();
    pose.translation() << -20.0 + 0.2 * i, -1.8 + 0.3 * std::sin(0.05 * i), 0.0;
    input.path.push_back({0.1 * i, pose});
  }
  input.T_map_robot = input.path.back().value;
  return input;
}

}  // namespace headway::scene
