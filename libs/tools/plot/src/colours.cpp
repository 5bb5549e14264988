// SPDX-License-Identifier: BSD-3-Clause
// Colours of charts.
#include <headway/plot/colours.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace headway::plot {

cv::Scalar bgr(Colour colour) {
  return {double(colour.blue), double(colour.green), double(colour.red)};
}

Colour lightened(Colour colour) {
  const auto half = [](std::uint8_t value) { return static_cast<std::uint8_t>((value + 255) / 2); };
  return {half(colour.red), half(colour.green), half(colour.blue)};
}

Colour categoryColour(std::size_t index) {
  static constexpr std::array<Colour, 8> kColours = {{{0, 114, 178},
                                                      {213, 94, 0},
                                                      {0, 158, 115},
                                                      {204, 121, 167},
                                                      {230, 159, 0},
                                                      {86, 180, 233},
                                                      {120, 94, 60},
                                                      {90, 90, 90}}};
  return kColours[index % kColours.size()];
}

Colour rampColour(double value) {
  static constexpr std::array<Colour, 5> kStops = {
      {{38, 84, 168}, {30, 150, 170}, {90, 175, 70}, {235, 160, 30}, {200, 30, 40}}};
  const double position = std::clamp(value, 0.0, 1.0) * (kStops.size() - 1);
  const auto i = std::min(kStops.size() - 2, static_cast<std::size_t>(position));
  const double t = position - static_cast<double>(i);
  const auto mix = [t](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround((1.0 - t) * a + t * b));
  };
  const Colour a = kStops[i];
  const Colour b = kStops[i + 1];
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

}  // namespace headway::plot
