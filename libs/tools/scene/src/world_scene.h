// SPDX-License-Identifier: BSD-3-Clause
// A map as a 3D scene of MRPT.
#pragma once

#include <headway/render/painter.h>
#include <headway/scene/snapshot.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <vector>

#include "canvas.h"

namespace headway::scene {

/// Drawing order of the objects in a 3D scene.
enum class DrawOrder { kOccupancy, kGrid, kLandmarks, kTruth, kPath, kRobot, kMovingObjects };

/// Sets the drawing order of an object. MRPT draws from far to near by one representative point
/// per object; these points are placed far below the scene, so that flat and translucent objects
/// are always drawn after the objects below them.
///
/// @param offset  position within the objects of the same order
void setDrawOrder(DrawOrder order, mrpt::opengl::CRenderizable& object, int offset = 0);

/// Builds the map as a 3D scene for a file, viewed from behind the robot.
///
/// Object names: `occupancy`, `ground_grid`, `dense`, `landmarks`, `true_path`, `camera_path`,
/// `robot`, `moving_objects`, `true_objects`, `camera`; those without content are left out.
///
/// @param options  theme and layers
[[nodiscard]] mrpt::opengl::COpenGLScene buildScene(const SnapshotInput& input,
                                                    const SnapshotOptions& options,
                                                    double ground_z);

/// The paths, the robot, and the moving objects' faces, trails and predictions, in the order in
/// which they are drawn over a picture of the map.
[[nodiscard]] std::vector<render::PaintedTriangle> pictureTriangles(const SnapshotInput& input,
                                                                    const Palette& palette,
                                                                    double ground_z);

}  // namespace headway::scene
