// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/object_class.h>
#include <headway/render/painter.h>
#include <headway/scene/snapshot.h>

namespace headway::scene {

/// Colours of pictures and scenes but those of object classes, which are in
/// headway/core/class_colour.h and the same in all themes.
struct Palette {
  render::Backdrop backdrop;
  Colour grid;
  Colour free;      ///< free cells of the occupancy grid
  Colour occupied;  ///< occupied cells
  Colour low;       ///< landmarks at ground level
  Colour high;      ///< landmarks 6 m above the ground
  Colour path;      ///< path, robot and camera
  Colour prediction;
  Colour truth;
  Colour panel;  ///< behind text
  Colour text;
  Colour dim_text;
  Colour label_mix;  ///< half of the colour of labels; the other half is the class's
  // Of the dense map, so that it is distinct from the ground and tracks stand out.
  double map_saturation = 1.0;
  double map_black = 0.0;  ///< brightness of its black, 0 to 1
  double map_white = 1.0;  ///< brightness of its white
};

inline constexpr Palette kDarkPalette{{{10, 14, 22}, {44, 54, 70}, {22, 26, 33}},
                                      {52, 60, 74},
                                      {52, 96, 84},
                                      {172, 78, 66},
                                      {110, 150, 200},
                                      {244, 214, 170},
                                      {255, 209, 71},
                                      kPredictionColour,
                                      kTruthColour,
                                      {14, 19, 26},
                                      {232, 236, 242},
                                      {150, 160, 175},
                                      {255, 255, 255},
                                      0.75,
                                      0.16,
                                      0.86};

inline constexpr Palette kLightPalette{{{176, 200, 226}, {238, 242, 246}, {216, 219, 222}},
                                       {186, 191, 197},
                                       {168, 206, 186},
                                       {200, 112, 96},
                                       {52, 92, 150},
                                       {150, 92, 30},
                                       {120, 62, 0},
                                       {0, 138, 52},
                                       {16, 16, 16},
                                       {255, 255, 255},
                                       {24, 28, 34},
                                       {84, 92, 104},
                                       {0, 0, 0},
                                       0.75,
                                       0.0,
                                       0.92};

[[nodiscard]] inline const Palette& paletteOf(Theme theme) {
  return theme == Theme::kLight ? kLightPalette : kDarkPalette;
}

/// Colour of a class's labels on the palette's panels.
[[nodiscard]] constexpr Colour labelColour(ObjectClass object_class, const Palette& palette) {
  const Colour own = colourOf(object_class);
  const auto half = [](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>((a + b) / 2);
  };
  return {half(own.red, palette.label_mix.red), half(own.green, palette.label_mix.green),
          half(own.blue, palette.label_mix.blue)};
}

}  // namespace headway::scene
