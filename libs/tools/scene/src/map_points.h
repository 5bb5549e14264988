// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/render/painter.h>
#include <headway/slam/map_view.h>
#include <mrpt/maps/CColouredPointsMap.h>

#include <opencv2/core/types.hpp>
#include <vector>

#include "palette.h"

namespace headway::scene {

/// Landmarks in their image intensity, tinted by their height above the ground.
///
/// @param scale  see sceneScale()
[[nodiscard]] std::vector<render::PaintedPoint> landmarkPoints(const slam::MapView& static_map,
                                                               double ground_z, double scale,
                                                               const Palette& palette);

/// The dense map in its colours, less saturated, so that tracks stand out.
[[nodiscard]] std::vector<render::PaintedPoint> densePoints(
    const mrpt::maps::CColouredPointsMap& dense, const Palette& palette);

/// Width of a landmark's dot: 2.6 points, and no less in pixels, so that it can be seen [px].
[[nodiscard]] double landmarkWidth(const cv::Size& picture);

}  // namespace headway::scene
