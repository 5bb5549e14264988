// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/object_class.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "palette.h"

namespace headway::scene {

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

}  // namespace headway::scene
