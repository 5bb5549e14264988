// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/map/map_file.h>
#include <headway/pipeline/perception.h>

#include <cstddef>
#include <vector>

namespace headway::pipeline {

/// One map of runs that have seen the same places, or of a single run.
struct JointMap {
  std::vector<std::size_t> runs;  ///< indices, ascending; the map's frame is that of the first one
  std::vector<Pose> T_map_run;    ///< of each: by which the beginning of its own map was moved
  std::size_t links = 0;          ///< keyframes that were recognised in the map of another run
  map::StoredMap stored;          ///< landmarks, keyframes and grid, for Perception::resume()
};

/// Joins the maps of finished runs (see slam::joinMaps()) and moves the map and the trajectory of
/// each run into the joint one. The moving objects at the end of a run, whose positions rest on its
/// own map, are removed from the map of each run that was joined with others.
///
/// Runs without images or with given poses have no landmarks, so that they stay alone.
///
/// @param runs  after finish(), with the same parameters and camera; none null
/// @return      by ascending first run; each run is in one of them
/// @throws InputError if the cameras differ
[[nodiscard]] std::vector<JointMap> joinMaps(const std::vector<Perception*>& runs);

}  // namespace headway::pipeline
