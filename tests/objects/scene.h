// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>
#include <headway/objects/moving_object_tracker.h>
#include <headway/objects/predictor.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace headway::objects::test {

inline constexpr double kFrame_s = 0.1;

/// A detection of a box that stands in the map, seen from a robot at the map's origin.
inline Detection seen(ObjectClass object_class, const Eigen::Vector3d& position, double yaw,
                      double score = 1.0) {
  const Eigen::Matrix3d R = robotFromOptical().linear().transpose();
  Box3d box;
  box.centre = R * position;
  box.yaw = opticalYaw(R * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0));
  const bool cyclist = object_class == ObjectClass::kCyclist;
  const bool person = cyclist || object_class == ObjectClass::kPedestrian;
  box.length = cyclist ? 1.8 : person ? 0.8 : 4.0;
  box.width = person ? 0.6 : 1.7;
  box.height = person ? 1.7 : 1.5;
  Detection detection;
  detection.object_class = object_class;
  detection.score = score;
  detection.box3d = box;
  return detection;
}

inline Detection seenCar(double x, double y, double yaw = 0.0) {
  return seen(ObjectClass::kCar, {x, y, 0.0}, yaw);
}

inline Detection seenPerson(double x, double y, double yaw = 0.0) {
  return seen(ObjectClass::kPedestrian, {x, y, 0.0}, yaw);
}

/// Feeds a tracker frame by frame from a robot that stands at the map's origin.
class Replay {
 public:
  explicit Replay(const ObjectsParams& params = {}) : tracker_(params) {}

  const TrackUpdate& frame(const std::vector<Detection>& items) { return frameAt(time_, items); }

  const TrackUpdate& frameAt(Time time, const std::vector<Detection>& items) {
    Detections detections;
    detections.time = time;
    detections.items = items;
    detections.all_detectors_ran = all_detectors_ran;
    last = tracker_.update(index_++, {time, Pose::Identity()}, detections);
    time_ = time + kFrame_s;
    for (const auto& [reason, count] : last.detections_dropped) dropped[reason] += count;
    used += last.detections_used;
    finalised.insert(finalised.end(), last.finalised.begin(), last.finalised.end());
    return last;
  }

  [[nodiscard]] Time time() const { return time_; }  ///< of the next frame
  MovingObjectTracker& tracker() { return tracker_; }

  bool all_detectors_ran = true;  ///< on the next frame
  TrackUpdate last;
  DropCounts dropped;
  std::size_t used = 0;
  std::vector<TrackSample> finalised;

 private:
  MovingObjectTracker tracker_;
  std::size_t index_ = 0;
  Time time_ = 0.0;
};

/// The confirmed tracks.
inline std::vector<Track> confirmed(const TrackUpdate& update) {
  std::vector<Track> tracks;
  for (const Track& track : update.tracks) {
    if (track.status == TrackStatus::kConfirmed) tracks.push_back(track);
  }
  return tracks;
}

/// The history of an object at the positions `place(t)`, 2 s at 10 Hz, current at t = 0.
template <typename Place>
std::vector<TrajectoryPoint> history(Place place, double span_s = 2.0, double step_s = 0.1) {
  std::vector<TrajectoryPoint> path;
  const int steps = static_cast<int>(std::lround(span_s / step_s));
  for (int k = -steps; k <= 0; ++k) {
    const double t = k * step_s;
    const Eigen::Vector2d here = place(t);
    const Eigen::Vector2d ahead = place(t + 1e-4) - here;
    const double yaw = ahead.norm() > 1e-9 ? std::atan2(ahead.y(), ahead.x()) : 0.0;
    path.push_back({static_cast<std::size_t>(k + steps), t, {here.x(), here.y(), 0.7}, yaw});
  }
  return path;
}

/// Place of a path at one horizon, rounded to a sample [m].
inline Eigen::Vector2d placeIn(const PredictedPath& path, double horizon_s) {
  const auto j = static_cast<std::size_t>(std::lround(horizon_s / kPredictionStep_s)) - 1;
  return path.points.at(j).position.head<2>();
}

}  // namespace headway::objects::test
