// SPDX-License-Identifier: BSD-3-Clause
// A finished replay frame by frame, with its truth and recorded images.
#pragma once

#include <headway/core/track.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::report {

/// Receives notes for the user, one line each.
using Note = std::function<void(const std::string&)>;

/// One frame of a finished replay.
struct ReplayFrame {
  std::size_t frame = 0;
  Time time = 0.0;                      ///< [s]
  Pose T_map_robot = Pose::Identity();  ///< final
  std::vector<Track> tracks;            ///< in the final map, with past paths and predictions
  std::optional<Pose> T_odom_robot;     ///< nullopt without trajectory_odom.tum
};

/// Sorts the tracks of a frame by their distance to the robot.
void sortByDistance(const Pose& T_map_robot, std::vector<Track>& tracks);

/// The recording of a replay.
struct ReplayInput {
  std::string rawlog;        ///< empty if unknown
  std::string sensor_label;  ///< of the camera in it; empty: the only one
};

/// Reads it from the replay.json of a replay's folder; empty if there is none.
[[nodiscard]] ReplayInput readReplayInput(const std::filesystem::path& folder);

/// What is read of a replay's frames.
struct ReplayFrameOptions {
  /// Of a longer replay every second, fourth, ... frame is read, so that memory is bounded.
  std::size_t max_frames = std::numeric_limits<std::size_t>::max();
  /// Of more boxes, the nearest of each frame are read, which is noted.
  std::size_t max_boxes = std::numeric_limits<std::size_t>::max();
  double past_s = 4.0;          ///< of each track's path, smoothed; 0: none [s]
  double horizon_step_s = 0.1;  ///< between the points of a prediction, a multiple of 0.1 s
};

/// Reads the frames of a replay's folder: final poses, and tracks transformed from the online to
/// the final map, with their past path and their predictions. Missing files of tracks and
/// predictions are noted.
///
/// @return ascending in time; at least one
/// @throws InputError if a file is malformed, `trajectory.tum` is missing or empty, or a killed run
///         left results of two runs
[[nodiscard]] std::vector<ReplayFrame> readReplayFrames(const std::filesystem::path& folder,
                                                        const ReplayFrameOptions& options,
                                                        const Note& note);

/// Truth in the frame of the estimated map.
struct ReplayTruth {
  std::vector<Stamped<Pose>> path;
  std::map<std::size_t, std::vector<Track>> objects;  ///< by frame
};

/// Reads `trajectory.tum` and `objects.csv` of a truth folder, aligned so that the true pose at the
/// first common time agrees with the estimate. A missing objects.csv is noted.
///
/// @throws InputError if trajectory.tum is missing, a file is malformed, or no times agree
[[nodiscard]] ReplayTruth readReplayTruth(const std::filesystem::path& folder,
                                          const std::vector<ReplayFrame>& frames, const Note& note);

/// Reads the left images of a replay's rawlog in order of time.
///
/// If the rawlog does not exist or has no images, this is noted once and all images are empty.
class RecordedImages {
 public:
  RecordedImages(const ReplayInput& input, std::size_t first_frame, const Note& note);
  ~RecordedImages();
  RecordedImages(const RecordedImages&) = delete;
  RecordedImages& operator=(const RecordedImages&) = delete;

  /// The image of a frame, in colour if available; empty if there is none. Frames must be requested
  /// in ascending order.
  [[nodiscard]] cv::Mat at(std::size_t frame);

 private:
  class Reader;
  std::unique_ptr<Reader> reader_;  ///< null without images
};

}  // namespace headway::report
