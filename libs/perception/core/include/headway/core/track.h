// SPDX-License-Identifier: BSD-3-Clause
// Tracks of objects: state, history and prediction.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/ids.h>
#include <headway/core/object_class.h>
#include <headway/core/pose.h>

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace headway {

/// Life cycle of a track; confirmed and coasting tracks are published.
enum class TrackStatus {
  kTentative,  ///< observed too few times to be shown
  kConfirmed,  ///< shown, and observed in this frame
  kCoasting,   ///< shown, not observed in this frame: predicted
  kEnded,      ///< unobserved for too long; its id is not used again
};

/// "tentative", "confirmed", "coasting", "ended".
[[nodiscard]] std::string_view toString(TrackStatus status);

/// Motion classification of a track.
enum class MotionState {
  kUnknown,  ///< the velocity is too uncertain to decide
  kMoving,
  kStatic,
};

/// "unknown", "moving", "static".
[[nodiscard]] std::string_view toString(MotionState state);

/// Predicted position of an object at one future time.
struct PredictedPoint {
  double horizon_s = 0.0;                                    ///< from the frame's time [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();        ///< box centre [m]
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Identity();  ///< of (x, y) [m^2]
};

/// One predicted path. A track's paths are ordered from the most probable down.
struct PredictedPath {
  int mode = 0;                        ///< number of the hypothesis, constant over frames
  double probability = 1.0;            ///< sums to 1 over the paths of one track
  std::vector<PredictedPoint> points;  ///< horizons 0.1 s, 0.2 s, ... 3.0 s
};

/// One past position of a track, as last smoothed.
struct TrajectoryPoint {
  std::size_t frame = 0;
  Time time = 0.0;                                     ///< [s]
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< box centre [m]
  double yaw = 0.0;                                    ///< of the front about z [rad]
};

/// Position at a past time, linearly interpolated; before the first point, that of the first one.
///
/// @param path  at least one point, times increasing
/// @param time  not after the last point's [s]
[[nodiscard]] Eigen::Vector3d positionAt(const std::vector<TrajectoryPoint>& path, Time time);

/// State of one tracked object in one frame, all in the odometry frame or all in the map. A value
/// without references.
struct Track {
  TrackId id;
  ObjectClass object_class = ObjectClass::kUnknown;
  TrackStatus status = TrackStatus::kTentative;
  MotionState motion_state = MotionState::kUnknown;  ///< with hysteresis
  double score = 0.0;                                ///< from its detections' scores

  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< box centre [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  double yaw = 0.0;                                    ///< of the front about z [rad]
  double yaw_rate = 0.0;                               ///< [rad/s]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();      ///< (length, width, height) [m]
  Eigen::Matrix3d position_covariance = Eigen::Matrix3d::Identity();  ///< [m^2]
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Identity();  ///< of (x, y) [m^2/s^2]

  std::optional<Box2d> box2d;                ///< as last observed, predicted to this frame [px]
  Time first_seen = 0.0;                     ///< [s]
  Time last_seen = 0.0;                      ///< [s]
  std::vector<TrajectoryPoint> recent_path;  ///< the smoothed window, oldest first
  std::vector<PredictedPath> predictions;    ///< empty for tentative tracks
};

/// The track in another frame: positions, velocity, headings, covariances, path and predictions.
///
/// @param T_to_from  from the frame of the track to the other one; boxes stay upright, so that
///                   headings turn by its yaw
[[nodiscard]] Track transformed(Track track, const Pose& T_to_from);
[[nodiscard]] std::vector<Track> transformed(std::vector<Track> tracks, const Pose& T_to_from);

/// Whether the track is published: confirmed or coasting.
[[nodiscard]] bool isShown(const Track& track);

/// Whether the track is classified as moving.
[[nodiscard]] bool isMoving(const Track& track);

/// State of a track in one frame: one row of `tracks.csv`.
struct TrackSample {
  std::size_t frame = 0;
  Time time = 0.0;  ///< [s]
  Track track;
};

}  // namespace headway
