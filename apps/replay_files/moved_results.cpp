// SPDX-License-Identifier: BSD-3-Clause
#include "moved_results.h"

#include <headway/core/output_file.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

namespace headway::replay {
namespace {

namespace fs = std::filesystem;

/// Covariance of (x, y) after a rotation. What was known about z is not part of it.
Eigen::Matrix2d turned(const Eigen::Matrix2d& covariance, const Pose& T_map_run) {
  const Eigen::Matrix2d R = T_map_run.linear().topLeftCorner<2, 2>();
  return R * covariance * R.transpose();
}

void moveTracks(const fs::path& path, const Pose& T_map_run) {
  OutputFile file(path);
  file.stream() << io::trackCsvHeader() << '\n';
  io::visitTrackCsv(path, [&](TrackSample row) {
    Track& track = row.track;
    track.position = T_map_run * track.position;
    track.yaw = wrapAngle(track.yaw + yawOf(T_map_run));
    track.velocity = T_map_run.linear() * track.velocity;
    const Eigen::Matrix2d covariance = track.position_covariance.topLeftCorner<2, 2>();
    track.position_covariance.topLeftCorner<2, 2>() = turned(covariance, T_map_run);
    track.velocity_covariance = turned(track.velocity_covariance, T_map_run);
    io::writeTrackCsv(file.stream(), row);
  });
  file.commit();
}

void moveMapOdom(const fs::path& path, const Pose& T_map_run) {
  OutputFile file(path);
  file.stream() << io::mapOdomCsvHeader() << '\n';
  io::visitMapOdomCsv(path, [&](io::MapOdomRow row) {
    row.T_map_odom = normalized(Pose(T_map_run * row.T_map_odom));
    io::writeMapOdomCsv(file.stream(), row);
  });
  file.commit();
}

void movePredictions(const fs::path& path, const Pose& T_map_run) {
  OutputFile file(path);
  file.stream() << io::predictionCsvHeader() << '\n';
  for (io::PredictionRow row : io::readPredictionCsv(path)) {
    row.point.position = T_map_run * row.point.position;
    row.point.covariance = turned(row.point.covariance, T_map_run);
    io::writePredictionCsv(file.stream(), row);
  }
  file.commit();
}

}  // namespace

void moveOnlineResults(const fs::path& folder, const Pose& T_map_run) {
  auto path = io::readTum(folder / "trajectory_online.tum");
  for (auto& pose : path) pose.value = normalized(Pose(T_map_run * pose.value));
  io::writeTum(folder / "trajectory_online.tum", path);
  moveMapOdom(folder / "map_odom.csv", T_map_run);
  moveTracks(folder / "tracks.csv", T_map_run);
  moveTracks(folder / "tracks_smoothed.csv", T_map_run);
  movePredictions(folder / "predictions.csv", T_map_run);
}

}  // namespace headway::replay
