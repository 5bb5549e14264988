// SPDX-License-Identifier: BSD-3-Clause
// Where objects will be, as cells of a grid.
#pragma once

#include <headway/map/map_query.h>

#include <vector>

#include "outgoing_messages.h"

namespace headway::ros2 {

/// Sets the cells of a grid to the probability that any object is there, in percent.
///
/// An object's footprint, as ratios of cells, is convolved with the distribution of its centre over
/// the cells around the most probable one, of which those within three standard deviations count.
///
/// @param obstacles  of one time, grouped by track
void setOccupancy(const std::vector<map::Obstacle>& obstacles, GridMessage& grid);

}  // namespace headway::ros2
