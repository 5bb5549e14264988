#pragma once

#include <headway/core/class_colour.h>

namespace headway::scene {

// Colours of what has no class; those of the classes are in headway/core/class_colour.h.
inline constexpr Colour kGroundColour{15, 19, 27};  ///< behind everything
inline constexpr Colour kGridColour{40, 48, 62};
inline constexpr Colour kLowColour{110, 150, 200};   ///< landmarks near the ground
inline constexpr Colour kHighColour{244, 214, 170};  ///< landmarks 6 m above it
inline constexpr Colour kPathColour{255, 209, 71};   ///< of the robot, and its camera
inline constexpr Colour kTextColour{232, 236, 242};
inline constexpr Colour kDimTextColour{150, 160, 175};

}  // namespace headway::scene
