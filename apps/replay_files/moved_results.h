// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <filesystem>

namespace headway::replay {

/// Moves what a run has written frame by frame in its own map into another one: positions,
/// headings, velocities and covariances in trajectory_online.tum, tracks.csv, tracks_smoothed.csv
/// and predictions.csv. Boxes stay upright. What these files contain otherwise stays as it is, and
/// so do the files in frames of the camera and the robot.
///
/// @param T_map_run  pose of the run's own map in the other one
/// @throws InputError if a file cannot be read or written
void moveOnlineResults(const std::filesystem::path& folder, const Pose& T_map_run);

}  // namespace headway::replay
