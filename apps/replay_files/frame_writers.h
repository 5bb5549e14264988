// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/output_file.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/pipeline/perception.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::replay {

/// Writes the results of each frame at once, so that a killed run lacks none of them:
/// trajectory_online.tum, trajectory_odom.tum, map_odom.csv, trajectory_covariance.csv,
/// detections.csv, tracks.csv, tracks_odom.csv,
/// tracks_smoothed.csv, tracks_kitti.txt and predictions.csv.
class FrameWriters {
 public:
  /// @param camera  null if the rawlog contains only poses and boxes
  FrameWriters(const std::filesystem::path& folder, std::shared_ptr<const StereoCamera> camera);

  /// @throws InputError naming the file that could not be written
  void write(const pipeline::PerceptionUpdate& update);
  void writeSmoothed(const std::vector<TrackSample>& samples);
  /// The files that grow.
  [[nodiscard]] std::vector<std::filesystem::path> paths() const;
  /// Ends all files and sets the scores of tracks_kitti.txt to the tracks' final scores.
  ///
  /// @throws InputError naming the file that could not be written
  void finish();

 private:
  void writeTrack(const pipeline::PerceptionUpdate& update, const Track& track,
                  const Pose& T_sensor_map);

  GrowingFile& open(const std::string& name);

  std::shared_ptr<const StereoCamera> camera_;
  std::filesystem::path folder_;
  std::map<std::string, GrowingFile> files_;  ///< by name
  GrowingFile& trajectory_;
  GrowingFile& odometry_;
  GrowingFile& map_odom_;
  GrowingFile& covariance_;
  GrowingFile& detections_;
  GrowingFile& tracks_;
  GrowingFile& tracks_odom_;
  GrowingFile& smoothed_;
  GrowingFile& kitti_;
  GrowingFile& predictions_;
};

/// Writes trajectory.tum and trajectory_kitti.txt.
///
/// trajectory_kitti.txt has a row for every frame from the first to the last; lost and skipped
/// frames repeat the previous pose (the first pose before tracking starts).
class TrajectoryWriter {
 public:
  /// @param T_robot_cam  pose of the left camera on the robot
  /// @throws InputError if the files cannot be written
  TrajectoryWriter(const std::filesystem::path& folder, const Pose& T_robot_cam);

  /// Adds a frame, in order.
  void add(const slam::FrameEstimate& estimate);
  void commit();  ///< @throws InputError if the files could not be written to the end

 private:
  Pose T_robot_cam_;
  OutputFile tum_, kitti_;
  std::optional<std::size_t> first_frame_;
  std::optional<Pose> T_first_map_;  ///< of the first tracked camera
  Pose last_ = Pose::Identity();     ///< of the camera in the first one
  std::size_t kitti_rows_ = 0;
};

}  // namespace headway::replay
