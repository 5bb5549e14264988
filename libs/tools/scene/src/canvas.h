// SPDX-License-Identifier: BSD-3-Clause
// Colours of pictures, and drawing on them: text, lines, occupancy, ground grid.
#pragma once

#include <headway/core/object_class.h>
#include <headway/render/painter.h>
#include <headway/render/pinhole_view.h>
#include <headway/scene/snapshot.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::scene {

/// Colours of pictures and scenes but those of object classes, which are in
/// headway/core/object_class.h and the same in all themes.
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

/// Pixels of one point, 1/720 of a picture's height; less in narrow pictures, at least 0.5.
[[nodiscard]] double pixelsPerPoint(const cv::Size& picture);

/// Draws text, panels and lines on a picture, with sizes in points.
class Canvas {
 public:
  /// @param picture  8-bit BGR; must outlive the canvas
  explicit Canvas(cv::Mat& picture, const Palette& palette = kDarkPalette);
  /// A canvas on a part of a picture, with the point size of the whole times `factor`.
  Canvas(cv::Mat& part, const Canvas& whole, double factor = 1.0)
      : picture_(part), palette_(whole.palette_), scale_(whole.scale_ * factor) {}

  [[nodiscard]] cv::Mat& picture() { return picture_; }
  [[nodiscard]] cv::Size size() const { return picture_.size(); }
  [[nodiscard]] const Palette& palette() const { return palette_; }
  /// Converts points to pixels, at least 1.
  [[nodiscard]] int px(double points) const;
  [[nodiscard]] cv::Size textSize(const std::string& text, double points) const;

  /// Text starting at the baseline point `at`; `points` is the height of capitals.
  ///
  /// @param halo  outline in the panels' colour, for text without a panel
  void text(const std::string& text, cv::Point at, double points, Colour colour, bool halo = true);
  /// Blends a rectangle with the panels' colour as background of text.
  void panel(cv::Rect rect, double opacity = 0.72);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double points, Colour colour);
  void filled(cv::Rect rect, Colour colour);
  void outline(cv::Rect rect, Colour colour);
  /// A filled convex polygon.
  void polygon(const std::vector<Eigen::Vector2d>& corners, Colour colour);
  /// Scales an image (grey or BGR) into a rectangle; no effect if it exceeds the picture.
  void image(const cv::Mat& source, cv::Rect rect);

 private:
  cv::Mat& picture_;
  const Palette& palette_;
  double scale_;
};

/// Cells of the occupancy grid in a square around a place: BGR, and opacity; the first row is that
/// of the lowest y. Unknown cells have no opacity.
struct OccupancyPicture {
  cv::Mat colours;      ///< 8-bit BGR; empty without cells in the area
  cv::Mat opacity;      ///< 8-bit
  double x_min = 0.0;   ///< left edge [m, map frame]
  double y_min = 0.0;   ///< lower edge [m, map frame]
  double cell_m = 0.0;  ///< side of a cell [m]
};

[[nodiscard]] OccupancyPicture occupancyAround(const mrpt::maps::COccupancyGridMap2D& grid,
                                               const Eigen::Vector3d& centre, double radius_m,
                                               const Palette& palette);

/// Blends the cells on the ground over a picture.
///
/// @param view  without roll
void drawOccupancy(const OccupancyPicture& occupancy, double ground_z,
                   const render::PinholeView& view, cv::Mat& picture);

/// Draws the lines of the ground grid around a place.
void drawGridLines(Canvas& canvas, const render::PinholeView& view, const Eigen::Vector3d& centre,
                   double ground_z, double spacing_m);

/// Lines of the ground grid to each side of the robot.
inline constexpr double kGridExtentLines = 15.0;

}  // namespace headway::scene
