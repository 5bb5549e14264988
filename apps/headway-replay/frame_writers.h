#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/pipeline/perception.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "output_folder.h"

namespace headway::replay {

/// Writes what each frame says as soon as it is known, so that an early end loses nothing:
/// trajectory_online.tum, detections.csv, tracks.csv, tracks_smoothed.csv, tracks_kitti.txt,
/// predictions.csv.
class FrameWriters {
 public:
  /// @param camera  null where the rawlog holds poses and boxes alone
  FrameWriters(const std::filesystem::path& folder, std::shared_ptr<const StereoCamera> camera);

  /// @throws InputError naming the file that could not be written
  void write(const pipeline::PerceptionUpdate& update);
  void writeSmoothed(const std::vector<TrackSample>& samples);
  /// Brings everything to disk, and gives every row of tracks_kitti.txt its track's last score.
  ///
  /// @throws InputError naming the file that could not be written
  void finish();

 private:
  void writeTrack(const pipeline::PerceptionUpdate& update, const Track& track,
                  const Pose& T_sensor_map);

  std::shared_ptr<const StereoCamera> camera_;
  OutputFile trajectory_;
  OutputFile detections_;
  OutputFile tracks_;
  OutputFile smoothed_;
  std::filesystem::path kitti_path_;
  OutputFile kitti_;
  OutputFile predictions_;
  std::map<std::int64_t, double> scores_;  ///< track id -> score, as last known
};

/// Writes trajectory.tum and trajectory_kitti.txt.
///
/// KITTI has a row for every frame from the first to the last; a lost or skipped one repeats the
/// last pose (before the first tracked one: the first).
///
/// @param T_robot_cam  left camera on the robot
void writeTrajectories(const std::filesystem::path& folder,
                       const std::vector<slam::FrameEstimate>& trajectory, const Pose& T_robot_cam);

}  // namespace headway::replay
