// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/scene/snapshot.h>

#include <functional>
#include <vector>

#include "canvas.h"

// Drawing on the finished picture: outlines and text, antialiased and in sizes of the picture.

namespace headway::scene {

/// The confirmed and coasting tracks.
[[nodiscard]] std::vector<const Track*> shownTracks(const std::vector<Track>& tracks);

/// Draws boxes, past paths and predictions over a camera image.
///
/// @param canvas  of the image, with the aspect ratio of `view`
/// @param scale   of the scene, see sceneScale()
void drawTracksOver(Canvas& canvas, const render::PinholeView& view,
                    const std::vector<Track>& tracks, double scale);

/// Draws landmarks as dots, as a substitute for a missing camera image.
void drawLandmarksOver(Canvas& canvas, const render::PinholeView& view,
                       const slam::MapView& static_map);

/// Whether the map hides a place [m, map frame].
using Hides = std::function<bool(const Eigen::Vector3d&)>;

/// Draws the edges of the shown tracks' boxes in class colours; thin while coasting and where the
/// map hides them.
///
/// @param hides  empty: nothing is hidden
void drawBoxes(Canvas& canvas, const render::PinholeView& view, const std::vector<Track>& tracks,
               const Hides& hides = {});

/// Draws the edges of the true boxes.
void drawTrueBoxes(Canvas& canvas, const render::PinholeView& view,
                   const std::vector<Track>& objects);

/// Draws the camera's viewing frustum.
void drawFrustum(Canvas& canvas, const render::PinholeView& view, const StereoCamera& camera,
                 const Pose& T_map_robot, double scale);

/// Writes frame, elapsed time, speed and number of tracks in the top left corner; this and the
/// following return the place that they take [px].
cv::Rect drawCaption(Canvas& canvas, const SnapshotInput& input);

/// Draws a scale bar in the bottom right corner, for the `top` view.
///
/// @param metres_per_pixel  on the ground
cv::Rect drawScaleBar(Canvas& canvas, double metres_per_pixel);

/// Writes the grid spacing in the bottom right corner, for perspective views.
cv::Rect drawGridNote(Canvas& canvas, double spacing_m);

/// Draws the camera image with the tracks in the top right corner; no effect without an image.
cv::Rect drawInset(Canvas& canvas, const SnapshotInput& input);

}  // namespace headway::scene
