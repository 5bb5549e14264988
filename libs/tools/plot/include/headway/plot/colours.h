// SPDX-License-Identifier: BSD-3-Clause
// Colours of charts.
#pragma once

#include <headway/core/object_class.h>

#include <cstddef>
#include <opencv2/core/types.hpp>

namespace headway::plot {

/// The colour in OpenCV's channel order, each channel 0 to 255.
[[nodiscard]] cv::Scalar bgr(Colour colour);

/// Halfway between the colour and white.
[[nodiscard]] Colour lightened(Colour colour);

/// Eight colours distinguishable in print and by most colour-blind readers, repeated cyclically.
///
/// @see Okabe & Ito 2008, "Color universal design"
[[nodiscard]] Colour categoryColour(std::size_t index);

/// Colour ramp from blue (0) through green to red (1); values outside [0, 1] are clamped.
[[nodiscard]] Colour rampColour(double value);

}  // namespace headway::plot
