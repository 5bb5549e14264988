// SPDX-License-Identifier: BSD-3-Clause
// Points and triangles to a picture, without OpenGL.
#pragma once

#include <headway/core/object_class.h>
#include <headway/render/pinhole_view.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::render {

/// Colours behind everything: a sky that turns from the horizon's colour to the zenith's, and the
/// ground, which turns to the horizon's colour in the distance.
struct Backdrop {
  Colour zenith, horizon, ground;
};

/// A point that is painted as a disc.
struct PaintedPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< map frame [m]
  Colour colour;
};

/// Points that are painted together, and the rows of the picture outside of which they have none.
struct PointRun {
  const PaintedPoint* points = nullptr;
  std::size_t count = 0;
  int top = 0;                                       ///< first row [px]
  int bottom = std::numeric_limits<int>::max() - 1;  ///< last row [px]
};

/// How points are drawn: as discs of a size in the world, within limits in the picture; as squares
/// of the same width where they are small.
struct PointStyle {
  float width_m = 0.0F;   ///< width [m]
  float min_px = 1.0F;    ///< minimum width in the picture [px]
  float max_px = 32.0F;   ///< maximum width in the picture [px]
  float nearer_m = 0.0F;  ///< distance to the camera by which a point is drawn nearer [m]
  float near_m = 0.0F;    ///< minimum depth of points that are drawn [m]
};

/// A triangle whose opacity may differ between its corners.
struct PaintedTriangle {
  std::array<Eigen::Vector3f, 3> corners;       ///< map frame [m]
  Colour colour;                                ///< of all corners
  std::array<float, 3> opacity{1.F, 1.F, 1.F};  ///< of each corner, 0 to 1
};

/// Draws large numbers of points, and translucent triangles among them, on the processor.
///
/// Not by OpenGL, because a software renderer takes 0.4 us for a point of one size in pixels, this
/// about 20 ns for one of a size in the world, with which near surfaces are closed and distant
/// ones keep their detail. Requires neither a display nor a graphics driver. Paints bands of the
/// picture in several threads; the same input gives the same bytes with any number of them.
///
///     Painter painter(1280, 720);
///     painter.clear(view, backdrop);
///     painter.paint(points.data(), points.size(), style);
///     painter.shade();
///     painter.paint(triangles, 0.3);
///     cv::Mat picture = painter.picture();
///
/// @see  Boucheny 2009, "Visualisation scientifique de grands volumes de donnees" (shade())
class Painter {
 public:
  /// @param width, height  of the pictures [px]
  Painter(int width, int height);

  /// Starts a picture with sky and ground.
  ///
  /// @param view  of the painter's width and height, without roll
  void clear(const PinholeView& view, const Backdrop& backdrop);

  /// Draws points; nearer ones hide those behind them.
  void paint(const std::vector<PointRun>& runs, const PointStyle& style);
  void paint(const PaintedPoint* points, std::size_t count, const PointStyle& style) {
    paint({{points, count}}, style);
  }

  /// Darkens points that are behind a nearer neighbour, which shows edges without lights.
  void shade();

  /// Blends triangles in their order over the picture. Where points hide them by more than a
  /// margin, they are drawn with a quarter of their opacity.
  ///
  /// @param margin_m  [m]
  void paint(const std::vector<PaintedTriangle>& triangles, double margin_m);

  /// Whether a point lies before a place of the map by more than a margin; false outside the
  /// picture.
  ///
  /// @param margin_m  [m]
  [[nodiscard]] bool hides(const Eigen::Vector3d& place_map, double margin_m) const;

  /// The picture so far, 8-bit BGR; overwritten by the next one.
  [[nodiscard]] cv::Mat& picture() {
    show();
    return colours_;
  }

 private:
  struct Corner {
    float u = 0.F, v = 0.F;     ///< [px]
    float inverse_depth = 0.F;  ///< [1/m]
    float opacity = 0.F;
  };
  struct Polygon {
    std::array<Corner, 4> corners;
    std::size_t count = 0;           ///< of corners
    int first_row = 0, end_row = 0;  ///< [px]
    Colour colour;
  };
  /// Rows that one thread paints.
  struct Band {
    int first = 0, end = 0;
  };
  [[nodiscard]] Band bandOf(int index) const;
  struct Projected;
  void projectBlock(const PaintedPoint* points, std::size_t count, const PointStyle& style,
                    Projected& out) const;
  void paintBlock(const PaintedPoint* points, std::size_t count, const PointStyle& style,
                  const Band& band);
  void paintDisc(float u, float v, float half, float z, std::uint32_t colour, const Band& band);
  [[nodiscard]] bool isHidden(float u, float v, float z, const Band& band) const;
  template <class Light>
  void showRow(int row, const Light& light);
  void show();
  [[nodiscard]] Polygon projected(const PaintedTriangle& triangle) const;
  void fill(const Polygon& polygon, float margin_m, const Band& band);
  void fillRow(int row, Corner left, Corner right, Colour colour, float margin_m);

  static constexpr int kBands = 6;
  static constexpr int kRowMargin =
      3;  ///< pixels behind a row, so that four can be painted at once

  PinholeView view_;
  Eigen::Matrix3f R_camera_map_ = Eigen::Matrix3f::Identity();
  Eigen::Vector3f t_camera_map_ = Eigen::Vector3f::Zero();
  cv::Mat colours_;    ///< 8-bit BGR
  cv::Mat points_;     ///< colours of the points, 0xRRGGBB
  cv::Mat depths_;     ///< 32-bit float [m]; kNoDepth where there is no point
  bool shown_ = true;  ///< whether colours_ contains the points
};

/// The view of a picture `factor` times as large.
[[nodiscard]] PinholeView enlarged(const PinholeView& view, int factor);

}  // namespace headway::render
