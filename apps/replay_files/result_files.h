// SPDX-License-Identifier: BSD-3-Clause
// The files of a run: rows of each frame, trajectories and checkpoints.
#pragma once

#include <headway/core/output_file.h>
#include <headway/core/params.h>
#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/core/worker_thread.h>
#include <headway/map/map_file.h>
#include <headway/pipeline/perception.h>
#include <headway/run/session.h>
#include <headway/slam/map_view.h>

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "summary.h"

namespace headway::replay {

/// Writes the results of each frame at once, so that a killed run lacks none of them:
/// trajectory_online.tum, trajectory_odom.tum, map_odom.csv, trajectory_covariance.csv,
/// detections.csv, tracks.csv, tracks_odom.csv,
/// tracks_smoothed.csv, tracks_kitti.txt and predictions.csv.
class FrameWriters {
 public:
  explicit FrameWriters(const std::filesystem::path& folder);

  /// @param camera  null if the rawlog contains only poses and boxes
  /// @throws InputError naming the file that could not be written
  void write(const pipeline::PerceptionUpdate& update, const StereoCamera* camera);
  void writeSmoothed(const std::vector<TrackSample>& samples);
  /// The files that grow.
  [[nodiscard]] std::vector<std::filesystem::path> paths() const;
  /// Ends all files and sets the scores of tracks_kitti.txt to the tracks' final scores.
  ///
  /// @throws InputError naming the file that could not be written
  void finish();

 private:
  void writeTrack(const pipeline::PerceptionUpdate& update, const Track& track,
                  const Pose& T_sensor_map, const StereoCamera* camera);

  std::ostream& open(const std::string& name, const std::string& header = "");

  std::filesystem::path folder_;
  std::map<std::string, GrowingFile> files_;  ///< by name
  std::ostream& trajectory_;
  std::ostream& odometry_;
  std::ostream& map_odom_;
  std::ostream& covariance_;
  std::ostream& detections_;
  std::ostream& tracks_;
  std::ostream& tracks_odom_;
  std::ostream& smoothed_;
  std::ostream& kitti_;
  std::ostream& predictions_;
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

/// Moves what a run has written frame by frame in its own map into another one: positions,
/// headings, velocities and covariances in trajectory_online.tum, tracks.csv, tracks_smoothed.csv
/// and predictions.csv. Boxes stay upright. What these files contain otherwise stays as it is, and
/// so do the files in frames of the camera and the robot.
///
/// @param T_map_run  pose of the run's own map in the other one
/// @throws InputError if a file cannot be read or written
void moveOnlineResults(const std::filesystem::path& folder, const Pose& T_map_run);

/// Binds the time between two checkpoints [s] to section [output].
void describeCheckpoints(double& interval_s, Params& params);

/// What a checkpoint contains: the results so far that are not written frame by frame.
struct CheckpointContents {
  slam::TrajectoryVisit trajectory;
  Pose T_robot_cam = Pose::Identity();
  map::StoredMap map;
  Summary summary;
  std::vector<std::filesystem::path> logs;  ///< files of rows, to be synchronised with the disk
};

/// Writes map.headway, map_points.ply, trajectory.tum, trajectory_kitti.txt and summary.json while
/// a run goes on, in a thread of its own that no frame waits for, so that a killed run leaves them.
class Checkpoint : public run::Sink {
 public:
  /// @param interval_s  time between two checkpoints; 0: none
  /// @param collect     what to write
  /// @param warn        called with the reason why a checkpoint could not be written
  Checkpoint(std::filesystem::path folder, double interval_s,
             std::function<CheckpointContents()> collect,
             std::function<void(const std::string&)> warn);

  void onFrame(const run::FrameResult& result, pipeline::Perception& perception) override;
  void onEnd(const std::optional<std::string>& failure) override;

 private:
  /// Whether the interval has passed, the last checkpoint is written, and collecting its contents
  /// took less than 2 % of the time since.
  [[nodiscard]] bool isDue() const;
  /// Waits for the end of writing.
  void finish();

  std::filesystem::path folder_;
  std::chrono::duration<double> interval_;
  std::function<CheckpointContents()> collect_;
  std::function<void(const std::string&)> warn_;
  std::chrono::steady_clock::time_point last_;
  std::chrono::duration<double> collecting_{0.0};  ///< duration of the last time
  std::future<void> writing_;
  WorkerThread writer_{WorkerThread::Priority::kBackground};
};

}  // namespace headway::replay
