// SPDX-License-Identifier: BSD-3-Clause
#include "map_points.h"

#include <headway/core/parallel_rows.h>

#include <algorithm>
#include <cmath>

#include "canvas.h"

namespace headway::scene {
namespace {

constexpr double kHighM = 6.0;     ///< of the highest tint above the ground, at scale 1
constexpr double kDotWidth = 2.6;  ///< [points]

/// Image intensity, brightened and tinted by height.
Colour colourOf(const slam::LandmarkView& landmark, double ground_z, double scale,
                const Palette& palette) {
  const double brightness = 0.55 + 0.45 * landmark.intensity / 255.0;
  const double height =
      std::clamp((landmark.position.z() - ground_z) / (kHighM * std::max(0.4, scale)), 0.0, 1.0);
  const auto mix = [&](std::uint8_t low, std::uint8_t high) {
    return static_cast<std::uint8_t>(brightness * (low + height * (high - low)));
  };
  return {mix(palette.low.red, palette.high.red), mix(palette.low.green, palette.high.green),
          mix(palette.low.blue, palette.high.blue)};
}

}  // namespace

std::vector<render::PaintedPoint> landmarkPoints(const slam::MapView& static_map, double ground_z,
                                                 double scale, const Palette& palette) {
  std::vector<render::PaintedPoint> points;
  points.reserve(static_map.landmarks.size());
  for (const auto& landmark : static_map.landmarks) {
    points.push_back(
        {landmark.position.cast<float>(), colourOf(landmark, ground_z, scale, palette)});
  }
  return points;
}

std::vector<render::PaintedPoint> densePoints(const mrpt::maps::CColouredPointsMap& dense,
                                              const Palette& palette) {
  const auto saturation = static_cast<float>(palette.map_saturation);
  const auto black = static_cast<float>(255.0 * palette.map_black);
  const auto range = static_cast<float>(255.0 * (palette.map_white - palette.map_black));
  std::vector<render::PaintedPoint> points(dense.size());
  forEachRow(static_cast<int>(points.size()), [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    auto& position = points[i].position;
    dense.getPointFast(i, position.x(), position.y(), position.z());
    float red = 0.F, green = 0.F, blue = 0.F;
    dense.getPointColor_fast(i, red, green, blue);
    const float grey = 0.299F * red + 0.587F * green + 0.114F * blue;
    const auto toned = [&](float value) {
      return static_cast<std::uint8_t>(
          std::clamp(black + range * (grey + saturation * (value - grey)), 0.F, 255.F));
    };
    points[i].colour = {toned(red), toned(green), toned(blue)};
  });
  return points;
}

double landmarkWidth(const cv::Size& picture) {
  return kDotWidth * std::max(1.0, pixelsPerPoint(picture));
}

}  // namespace headway::scene
