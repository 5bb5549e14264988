#pragma once

#include <headway/map/moving_objects_map.h>

namespace mrpt::opengl {
class CSetOfObjects;
}

namespace headway::map {

/// Adds the 3D objects that show tracks, one object a kind and not one a track (drawing costs by
/// the object): `uncertainty`, `predictions`, `trails`, `faces`, `edges_<class>`, `labels`.
void insertTrackVisual(const std::vector<Track>& tracks,
                       const CMovingObjectsMap::TInsertionOptions& options,
                       mrpt::opengl::CSetOfObjects& out);

}  // namespace headway::map
