// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "grain.h"
#include "mesh.h"

namespace headway::sim {

/// Overcast sky with clouds, and hills and roofs along the horizon: u around, v down.
[[nodiscard]] cv::Mat drawSky(Random& random);

/// A drum around the camera that carries the sky's picture.
///
/// @param radius  [m]; far enough that nothing is behind it
[[nodiscard]] Mesh skyMesh(float radius);

}  // namespace headway::sim
