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

/// Where notes for the user go, one line each.
using Note = std::function<void(const std::string&)>;

/// One frame of a finished replay.
struct ReplayFrame {
  std::size_t frame = 0;
  Time time = 0.0;                      ///< [s]
  Pose T_map_robot = Pose::Identity();  ///< final
  std::vector<Track> tracks;            ///< moved to the final map, with past and predictions
};

/// What a replay left in its folder, as far as it can be drawn.
struct FinishedReplay {
  map::PerceptionMap map;                      ///< its moving layer is replaced frame by frame
  std::shared_ptr<const StereoCamera> camera;  ///< null where poses came from elsewhere
  std::vector<ReplayFrame> frames;             ///< ascending; at least one
  std::string rawlog;                          ///< replayed; empty if not known
  std::string sensor_label;                    ///< of the camera in it
};

/// Reads a replay's folder, or a map file alone (one frame: its last keyframe).
///
/// What is missing is left out and noted: the map, tracks, predictions, the calibration.
///
/// @throws InputError if there is neither a trajectory nor a map, or what is there is broken
[[nodiscard]] FinishedReplay readReplay(const std::string& input, const Note& note);

}  // namespace headway::render_program
