// SPDX-License-Identifier: BSD-3-Clause
// Boxes, trails and predicted paths of tracks as geometry to draw.
#pragma once

#include <headway/core/object_class.h>
#include <headway/core/track.h>

#include <Eigen/Core>
#include <array>
#include <functional>
#include <utility>
#include <vector>

namespace mrpt::opengl {
class CSetOfTriangles;
}

namespace headway::map {

/// Corners of a track's box in the map frame [m]: four on the ground, then the four above them;
/// each four from front left over front right and rear right to rear left.
[[nodiscard]] std::array<Eigen::Vector3d, 8> boxCorners(const Track& track);

/// The twelve edges of a box, as pairs of corner numbers.
inline constexpr std::array<std::pair<int, int>, 12> kBoxEdges = {{{0, 1},
                                                                   {1, 2},
                                                                   {2, 3},
                                                                   {3, 0},
                                                                   {4, 5},
                                                                   {5, 6},
                                                                   {6, 7},
                                                                   {7, 4},
                                                                   {0, 4},
                                                                   {1, 5},
                                                                   {2, 6},
                                                                   {3, 7}}};

/// Where the track was, on the ground under the box's centre, oldest first, its present place
/// last [m].
[[nodiscard]] std::vector<Eigen::Vector3d> groundTrail(const Track& track);

/// Where one of its predictions leads, on the ground, its present place first [m].
[[nodiscard]] std::vector<Eigen::Vector3d> groundPath(const Track& track,
                                                      const PredictedPath& prediction);

/// Length of a polyline [m].
[[nodiscard]] double lengthOf(const std::vector<Eigen::Vector3d>& polyline);

/// The dashes of a polyline: `dash` [m] drawn and `gap` [m] omitted alternately.
[[nodiscard]] std::vector<std::vector<Eigen::Vector3d>> dashesOf(
    const std::vector<Eigen::Vector3d>& polyline, double dash, double gap);

/// Opacity (0 to 255) at a fraction (0 to 1) of a ribbon's length.
using Fade = std::function<double(double)>;

/// Half the width of a ribbon at its points [m].
using HalfWidths = std::vector<double>;

/// Adds a horizontal band along a polyline, with its width in metres.
///
/// @param half_widths  one for each point; the band is mitred at bends
/// @throws             nothing; fewer than two points add nothing
void appendRibbon(const std::vector<Eigen::Vector3d>& polyline, const HalfWidths& half_widths,
                  Colour colour, const Fade& opacity, mrpt::opengl::CSetOfTriangles& out);

/// The same with one width [m] and one opacity (0 to 255).
void appendRibbon(const std::vector<Eigen::Vector3d>& polyline, double width, Colour colour,
                  double opacity, mrpt::opengl::CSetOfTriangles& out);

}  // namespace headway::map
