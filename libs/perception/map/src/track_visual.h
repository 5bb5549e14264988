// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/object_class.h>
#include <headway/map/moving_objects_map.h>

namespace mrpt::opengl {
class CSetOfObjects;
}

namespace headway::map {

/// Adds the 3D objects that show tracks, one per kind and not one per track, since drawing time
/// depends on the number of objects: `uncertainty`, `predictions`, `trails`, `faces`,
/// `edges_<class>`, `labels`.
///
/// @param scale              of widths of paths and lengths of dashes; 1 for streets
/// @param prediction_colour  of predicted paths and their uncertainty
void insertTrackVisual(const std::vector<Track>& tracks,
                       const CMovingObjectsMap::TInsertionOptions& options, double scale,
                       Colour prediction_colour, mrpt::opengl::CSetOfObjects& out);

}  // namespace headway::map
