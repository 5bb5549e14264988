#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/map/perception_map.h>

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace headway::render_program {

/// Receives notes for the user, one line each.
using Note = std::function<void(const std::string&)>;

/// One frame of a finished replay.
struct ReplayFrame {
  std::size_t frame = 0;
  Time time = 0.0;                      ///< [s]
  Pose T_map_robot = Pose::Identity();  ///< final
  std::vector<Track> tracks;            ///< in the final map, with past paths and predictions
};

/// The results of a replay that can be drawn.
struct FinishedReplay {
  map::PerceptionMap map;                      ///< its moving objects are replaced at each frame
  std::shared_ptr<const StereoCamera> camera;  ///< null if the poses were recorded
  std::vector<ReplayFrame> frames;             ///< ascending; at least one
  std::string rawlog;                          ///< input of the replay; empty if unknown
  std::string sensor_label;                    ///< of the camera in it
};

/// Reads a replay's folder, or a map file alone (one frame: its last keyframe).
///
/// Missing map, tracks, predictions and calibration are omitted and noted.
///
/// @throws InputError if there is neither a trajectory nor a map, or a file is malformed
[[nodiscard]] FinishedReplay readReplay(const std::string& input, const Note& note);

/// Reads the frames of a replay's folder: final poses, and tracks transformed from the online to
/// the final map, with the past 4 s of their path and their predictions.
///
/// @throws InputError if a file is malformed or `trajectory.tum` is missing or empty
[[nodiscard]] std::vector<ReplayFrame> readFrames(const std::string& folder, const Note& note);

/// Truth in the frame of the estimated map.
struct Truth {
  std::vector<Stamped<Pose>> path;
  std::map<std::size_t, std::vector<Track>> objects;  ///< by frame
};

/// Reads `trajectory.tum` and `objects.csv` of a truth folder, aligned so that the true pose at the
/// first common time agrees with the estimate. A missing objects.csv is noted.
///
/// @throws InputError if trajectory.tum is missing, a file is malformed, or no times agree
[[nodiscard]] Truth readTruth(const std::string& folder, const std::vector<ReplayFrame>& frames,
                              const Note& note);

}  // namespace headway::render_program
