#pragma once

#include <headway/core/output_file.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/pipeline/perception.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace headway::replay {

/// Writes the results of each frame at once, so that a killed run lacks at most its last second:
/// trajectory_online.tum, trajectory_covariance.csv, detections.csv, tracks.csv,
/// tracks_smoothed.csv, tracks_kitti.txt, predictions.csv.
class FrameWriters {
 public:
  /// @param camera  null if the rawlog contains only poses and boxes
  FrameWriters(const std::filesystem::path& folder, std::shared_ptr<const StereoCamera> camera);

  /// @throws InputError naming the file that could not be written
  void write(const pipeline::PerceptionUpdate& update);
  void writeSmoothed(const std::vector<TrackSample>& samples);
  /// Ends all files and sets the scores of tracks_kitti.txt to the tracks' final scores.
  ///
  /// @throws InputError naming the file that could not be written
  void finish();

 private:
  void writeTrack(const pipeline::PerceptionUpdate& update, const Track& track,
                  const Pose& T_sensor_map);

  std::shared_ptr<const StereoCamera> camera_;
  GrowingFile trajectory_;
  GrowingFile covariance_;
  GrowingFile detections_;
  GrowingFile tracks_;
  GrowingFile smoothed_;
  std::filesystem::path kitti_path_;
  GrowingFile kitti_;
  GrowingFile predictions_;
  std::map<std::int64_t, double> scores_;  ///< track id -> latest score
};

/// Writes trajectory.tum and trajectory_kitti.txt.
///
/// trajectory_kitti.txt has a row for every frame from the first to the last; lost and skipped
/// frames repeat the previous pose (the first pose before tracking starts).
///
/// @param T_robot_cam  pose of the left camera on the robot
void writeTrajectories(const std::filesystem::path& folder,
                       const std::vector<slam::FrameEstimate>& trajectory, const Pose& T_robot_cam);

}  // namespace headway::replay
