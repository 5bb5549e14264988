// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/track.h>
#include <headway/core/warnings.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>

namespace headway::pipeline {

/// Which frames a stored run contains, and which of them to repeat when it is continued.
struct RunExtent {
  std::size_t last_frame = 0;   ///< index
  Time last_time = 0.0;         ///< of that frame [s]
  std::size_t repeat_from = 0;  ///< index of the first frame to process again
};

/// State of a run after its last frame, apart from map and trajectory.
struct RunState {
  RunExtent extent;
  std::size_t grid_frames = 0;
  std::int64_t next_track_id = 0;
  std::map<TrackId, Eigen::Vector3d> tracks;  ///< centres of all tracks in the map [m]
  Warnings warnings;
  std::map<std::string, std::size_t> laser_counts;
};

/// The extent of a run stored by Perception::runState().
///
/// @throws InputError if the bytes are cut off, damaged or of another version
[[nodiscard]] RunExtent extentOf(const std::string& run_state);

}  // namespace headway::pipeline
