// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/object_class.h>

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace mrpt::opengl {
class CSetOfTriangles;
}

namespace headway::map {

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
