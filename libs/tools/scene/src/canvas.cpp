// SPDX-License-Identifier: BSD-3-Clause
// Colours of pictures, and drawing on them: text, lines, occupancy, ground grid.
#include "canvas.h"

#include <headway/core/parallel_rows.h>
#include <headway/plot/colours.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::scene {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr double kCapitalHeight = 21.0;  ///< of the font at scale 1 [px]
constexpr int kSubpixelBits = 4;

cv::Point subpixel(const Eigen::Vector2d& point) {
  const double factor = 1 << kSubpixelBits;
  return {static_cast<int>(std::lround(point.x() * factor)),
          static_cast<int>(std::lround(point.y() * factor))};
}

/// In proportion to the text, so that it is as legible in a large picture as in a small one.
int thicknessOf(double font_scale) {
  return std::max(1, static_cast<int>(std::lround(0.06 * font_scale * kCapitalHeight)));
}

}  // namespace

double pixelsPerPoint(const cv::Size& picture) {
  return std::max(0.5, std::min(picture.height / 720.0, picture.width / 960.0));
}

Canvas::Canvas(cv::Mat& picture, const Palette& palette)
    : picture_(picture), palette_(palette), scale_(pixelsPerPoint(picture.size())) {}

int Canvas::px(double points) const {
  return std::max(1, static_cast<int>(std::lround(points * scale_)));
}

cv::Size Canvas::textSize(const std::string& text, double points) const {
  const double font_scale = points * scale_ / kCapitalHeight;
  int baseline = 0;
  return cv::getTextSize(text, kFont, font_scale, thicknessOf(font_scale), &baseline);
}

void Canvas::text(const std::string& text, cv::Point at, double points, Colour colour, bool halo) {
  const double font_scale = points * scale_ / kCapitalHeight;
  const int thickness = thicknessOf(font_scale);
  if (halo) {
    cv::putText(picture_, text, at, kFont, font_scale, plot::bgr(palette_.panel), thickness + px(2),
                cv::LINE_AA);
  }
  cv::putText(picture_, text, at, kFont, font_scale, plot::bgr(colour), thickness, cv::LINE_AA);
}

void Canvas::panel(cv::Rect rect, double opacity) {
  rect &= cv::Rect({0, 0}, picture_.size());
  if (rect.empty()) return;
  cv::Mat background = picture_(rect);
  background.convertTo(background, -1, 1.0 - opacity, 0.0);
  background += plot::bgr(palette_.panel) * opacity;
}

void Canvas::line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double points,
                  Colour colour) {
  cv::line(picture_, subpixel(from), subpixel(to), plot::bgr(colour), px(points), cv::LINE_AA,
           kSubpixelBits);
}

void Canvas::filled(cv::Rect rect, Colour colour) {
  cv::rectangle(picture_, rect, plot::bgr(colour), cv::FILLED);
}

void Canvas::outline(cv::Rect rect, Colour colour) {
  cv::rectangle(picture_, rect, plot::bgr(colour), 1);
}

void Canvas::polygon(const std::vector<Eigen::Vector2d>& corners, Colour colour) {
  std::vector<cv::Point> points;
  for (const auto& corner : corners) points.push_back(subpixel(corner));
  cv::fillConvexPoly(picture_, points, plot::bgr(colour), cv::LINE_AA, kSubpixelBits);
}

void Canvas::image(const cv::Mat& source, cv::Rect rect) {
  const cv::Rect inside = rect & cv::Rect({0, 0}, picture_.size());
  if (inside != rect || source.empty()) return;
  cv::Mat colour = source;
  if (source.channels() == 1) cv::cvtColor(source, colour, cv::COLOR_GRAY2BGR);
  const bool shrinks = rect.width < source.cols;
  cv::resize(colour, picture_(rect), rect.size(), 0.0, 0.0,
             shrinks ? cv::INTER_AREA : cv::INTER_CUBIC);
}

namespace {

/// @param free  probability; cells of about a half are not shown
void paintCell(float free, const Palette& palette, cv::Vec3b& colour, std::uint8_t& opacity) {
  const bool occupied = free < 0.4F;
  const Colour shown = occupied ? palette.occupied : palette.free;
  colour = {shown.blue, shown.green, shown.red};
  opacity = occupied ? 190 : free > 0.6F ? 110 : 0;
}

/// @param opacity  0 to 255
cv::Vec3b blended(const cv::Vec3b& below, const cv::Vec3b& above, int opacity) {
  cv::Vec3b result;
  for (int i = 0; i < 3; ++i) {
    result[i] = static_cast<std::uint8_t>((below[i] * (255 - opacity) + above[i] * opacity) / 255);
  }
  return result;
}

}  // namespace

OccupancyPicture occupancyAround(const mrpt::maps::COccupancyGridMap2D& grid,
                                 const Eigen::Vector3d& centre, double radius_m,
                                 const Palette& palette) {
  OccupancyPicture result;
  result.cell_m = static_cast<double>(grid.getResolution());
  const auto x_min = static_cast<double>(grid.getXMin());
  const auto y_min = static_cast<double>(grid.getYMin());
  const auto cell = [&](double metres, double edge) {
    return static_cast<int>(std::floor((metres - edge) / result.cell_m));
  };
  const int left = std::max(0, cell(centre.x() - radius_m, x_min));
  const int bottom = std::max(0, cell(centre.y() - radius_m, y_min));
  const int right =
      std::min(static_cast<int>(grid.getSizeX()), cell(centre.x() + radius_m, x_min) + 1);
  const int top =
      std::min(static_cast<int>(grid.getSizeY()), cell(centre.y() + radius_m, y_min) + 1);
  if (left >= right || bottom >= top) return result;
  result.x_min = x_min + result.cell_m * left;
  result.y_min = y_min + result.cell_m * bottom;
  result.colours.create(top - bottom, right - left, CV_8UC3);
  result.opacity.create(top - bottom, right - left, CV_8UC1);
  forEachRow(top - bottom, [&](int row) {
    auto* colour = result.colours.ptr<cv::Vec3b>(row);
    auto* opacity = result.opacity.ptr<std::uint8_t>(row);
    for (int x = left; x < right; ++x, ++colour, ++opacity) {
      paintCell(grid.getCell(x, bottom + row), palette, *colour, *opacity);
    }
  });
  return result;
}

void drawOccupancy(const OccupancyPicture& occupancy, double ground_z,
                   const render::PinholeView& view, cv::Mat& picture) {
  if (occupancy.colours.empty()) return;
  const Eigen::Vector3d viewpoint = view.T_map_camera.translation();
  const double drop = ground_z - viewpoint.z();
  const double x_origin = (viewpoint.x() - occupancy.x_min) / occupancy.cell_m;
  const double y_origin = (viewpoint.y() - occupancy.y_min) / occupancy.cell_m;
  const Eigen::Vector3d across = view.T_map_camera.linear().col(0) / view.fx;
  forEachRow(picture.rows, [&](int row) {
    const Eigen::Vector3d ray = view.T_map_camera.linear() *
                                Eigen::Vector3d(-view.cx / view.fx, (row - view.cy) / view.fy, 1.0);
    const double scale = drop / ray.z();  // of the whole row, without roll
    if (!(scale > 0.0 && scale < view.far_m)) return;
    const double cells = scale / occupancy.cell_m;
    const double x_left = x_origin + cells * ray.x(), x_step = cells * across.x();
    const double y_left = y_origin + cells * ray.y(), y_step = cells * across.y();
    auto* pixel = picture.ptr<cv::Vec3b>(row);
    for (int column = 0; column < picture.cols; ++column) {
      const double x = x_left + column * x_step, y = y_left + column * y_step;
      if (!(x >= 0.0 && y >= 0.0 && x < occupancy.colours.cols && y < occupancy.colours.rows)) {
        continue;
      }
      const int cell_x = static_cast<int>(x), cell_y = static_cast<int>(y);
      const int opacity = occupancy.opacity.ptr<std::uint8_t>(cell_y)[cell_x];
      if (opacity == 0) continue;
      pixel[column] =
          blended(pixel[column], occupancy.colours.ptr<cv::Vec3b>(cell_y)[cell_x], opacity);
    }
  });
}

void drawGridLines(Canvas& canvas, const render::PinholeView& view, const Eigen::Vector3d& centre,
                   double ground_z, double spacing_m) {
  const double extent = kGridExtentLines * spacing_m;
  const double x = spacing_m * std::round(centre.x() / spacing_m);
  const double y = spacing_m * std::round(centre.y() / spacing_m);
  const auto draw = [&](const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
    const auto segment = render::projectSegment(from, to, view);
    if (segment) canvas.line(segment->first, segment->second, 1.0, canvas.palette().grid);
  };
  const int lines = static_cast<int>(kGridExtentLines);
  for (int i = -lines; i <= lines; ++i) {
    const double offset = i * spacing_m;
    draw({x + offset, y - extent, ground_z}, {x + offset, y + extent, ground_z});
    draw({x - extent, y + offset, ground_z}, {x + extent, y + offset, ground_z});
  }
}

}  // namespace headway::scene
