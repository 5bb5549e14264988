#pragma once

#include <mrpt/opengl/CRenderizable.h>

namespace headway::scene {

/// What is drawn first, next, ... in a 3D scene.
enum class DrawOrder { kGrid, kLandmarks, kTruth, kPath, kRobot, kMovingObjects };

/// Objects are drawn from the farthest to the nearest by one point of each. These stand far below
/// the world, so that flat and see-through things always come after what they lie upon.
inline void drawInOrder(DrawOrder order, mrpt::opengl::CRenderizable& object, int after = 0) {
  const int place = static_cast<int>(order) + after;
  object.setLocalRepresentativePoint({0.f, 0.f, -8000.f + 500.f * static_cast<float>(place)});
}

}  // namespace headway::scene
