#pragma once

#include <headway/scene/snapshot.h>

#include "canvas.h"

namespace headway::scene {

// Outlines are drawn on the finished picture and not in OpenGL, where lines are one pixel wide.

/// The edges of the believed tracks' boxes, coloured by class; thin while a track is coasting.
void drawBoxes(Canvas& canvas, const render::PinholeView& view, const std::vector<Track>& tracks);

/// The edges of the true boxes.
void drawTrueBoxes(Canvas& canvas, const render::PinholeView& view,
                   const std::vector<Track>& objects);

/// The pyramid that the robot's camera sees, cut off near the camera.
void drawFrustum(Canvas& canvas, const render::PinholeView& view, const StereoCamera& camera,
                 const Pose& T_map_robot);

}  // namespace headway::scene
