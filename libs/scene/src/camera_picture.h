#pragma once

#include <headway/scene/snapshot.h>

#include "canvas.h"

namespace headway::scene {

/// Draws boxes, past paths and predictions over the camera's image, where they project.
///
/// @param canvas  holds the image (or nothing), in the proportions of `view`
void drawTracksOver(Canvas& canvas, const render::PinholeView& view,
                    const std::vector<Track>& tracks);

/// Draws landmarks as dots: what the camera would see where there is no image.
void drawLandmarksOver(Canvas& canvas, const render::PinholeView& view,
                       const slam::MapView& still_world);

}  // namespace headway::scene
