// SPDX-License-Identifier: BSD-3-Clause
// A finished replay, read from its folder or from its map alone.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/map/perception_map.h>
#include <headway/report/replay_frames.h>

#include <memory>
#include <string>
#include <vector>

namespace headway::render_program {

using report::Note;
using report::ReplayFrame;

/// The results of a replay that can be drawn.
struct FinishedReplay {
  map::PerceptionMap map;                      ///< its moving objects are replaced at each frame
  std::shared_ptr<const StereoCamera> camera;  ///< null if the poses were recorded
  std::vector<ReplayFrame> frames;             ///< ascending; at least one
  report::ReplayInput input;
};

/// Reads a replay's folder, or a map file alone (one frame: its last keyframe).
///
/// Missing map, tracks, predictions and calibration are omitted and noted.
///
/// @throws InputError if there is neither a trajectory nor a map, or a file is malformed
[[nodiscard]] FinishedReplay readReplay(const std::string& input, const Note& note);

}  // namespace headway::render_program
