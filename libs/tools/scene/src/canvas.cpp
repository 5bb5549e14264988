// SPDX-License-Identifier: BSD-3-Clause
#include "canvas.h"

#include <headway/plot/colours.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::scene {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
constexpr double kCapitalHeight = 21.0;  ///< of the font at scale 1 [px]
constexpr double kStroke = 0.06;         ///< ratio of the capitals' height
constexpr int kSubpixelBits = 4;

cv::Point subpixel(const Eigen::Vector2d& point) {
  const double factor = 1 << kSubpixelBits;
  return {static_cast<int>(std::lround(point.x() * factor)),
          static_cast<int>(std::lround(point.y() * factor))};
}

/// In proportion to the text, so that it is as legible in a large picture as in a small one.
int thicknessOf(double font_scale) {
  return std::max(1, static_cast<int>(std::lround(kStroke * font_scale * kCapitalHeight)));
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

}  // namespace headway::scene
