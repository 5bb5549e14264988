#pragma once

#include <headway/scene/snapshot.h>

#include "canvas.h"

namespace headway::scene {

/// Writes class and id above each box, the nearest first; labels that would cover others are left
/// out.
void drawLabels(Canvas& canvas, const render::PinholeView& view, const std::vector<Track>& tracks);

/// Frame, time since the start, speed and number of tracks, at the top left.
void drawCaption(Canvas& canvas, const SnapshotInput& input);

/// A bar of a round number of metres; only where all of the ground is equally far (`top` view).
///
/// @param metres_per_pixel  on the ground
void drawScaleBar(Canvas& canvas, double metres_per_pixel);

/// Says how wide the grid's squares are, where a bar would mislead.
void drawGridNote(Canvas& canvas);

/// The camera's image with the boxes over it, at the top right; nothing where there is no image.
void drawInset(Canvas& canvas, const SnapshotInput& input);

}  // namespace headway::scene
