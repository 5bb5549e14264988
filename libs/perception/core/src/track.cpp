// SPDX-License-Identifier: BSD-3-Clause
// Tracks of objects: state, history and prediction.
#include <headway/core/track.h>

#include <algorithm>
#include <utility>

namespace headway {

std::string_view toString(TrackStatus status) {
  switch (status) {
    case TrackStatus::kTentative:
      return "tentative";
    case TrackStatus::kConfirmed:
      return "confirmed";
    case TrackStatus::kCoasting:
      return "coasting";
    case TrackStatus::kEnded:
      return "ended";
  }
  return "unknown";
}

std::string_view toString(MotionState state) {
  switch (state) {
    case MotionState::kUnknown:
      return "unknown";
    case MotionState::kMoving:
      return "moving";
    case MotionState::kStatic:
      return "static";
  }
  return "unknown";
}

Eigen::Vector3d positionAt(const std::vector<TrajectoryPoint>& path, Time time) {
  const std::size_t last = path.size() - 1;
  if (last == 0 || time <= path.front().time) return path.front().position;
  // The index is estimated first, since samples mostly have a constant rate.
  const double steps = static_cast<double>(last) / (path.back().time - path.front().time);
  const double estimate = (time - path.front().time) * steps;
  std::size_t later = std::min(last, static_cast<std::size_t>(std::max(1.0, estimate + 0.5)));
  while (later < last && path[later].time < time) ++later;
  while (later > 1 && path[later - 1].time >= time) --later;
  const TrajectoryPoint& a = path[later - 1];
  const TrajectoryPoint& b = path[later];
  const double fraction = std::min(1.0, (time - a.time) / (b.time - a.time));
  return a.position + fraction * (b.position - a.position);
}

Track transformed(Track track, const Pose& T_to_from) {
  const Eigen::Matrix3d R = T_to_from.linear();
  const Eigen::Matrix2d plane = R.topLeftCorner<2, 2>();
  const double turn = yawOf(T_to_from);
  const auto turned = [&](const Eigen::Matrix2d& covariance) -> Eigen::Matrix2d {
    return plane * covariance * plane.transpose();
  };
  track.position = T_to_from * track.position;
  track.velocity = R * track.velocity;
  track.yaw = wrapAngle(track.yaw + turn);
  track.position_covariance = R * track.position_covariance * R.transpose();
  track.velocity_covariance = turned(track.velocity_covariance);
  for (TrajectoryPoint& point : track.recent_path) {
    point.position = T_to_from * point.position;
    point.yaw = wrapAngle(point.yaw + turn);
  }
  for (PredictedPath& path : track.predictions) {
    for (PredictedPoint& point : path.points) {
      point.position = T_to_from * point.position;
      point.covariance = turned(point.covariance);
    }
  }
  return track;
}

std::vector<Track> transformed(std::vector<Track> tracks, const Pose& T_to_from) {
  for (Track& track : tracks) track = transformed(std::move(track), T_to_from);
  return tracks;
}

bool isShown(const Track& track) {
  return track.status == TrackStatus::kConfirmed || track.status == TrackStatus::kCoasting;
}

bool isMoving(const Track& track) { return track.motion_state == MotionState::kMoving; }

}  // namespace headway
