// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/class_colour.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::scene {

// Colours of everything but object classes, which are in headway/core/class_colour.h.
inline constexpr Colour kBackgroundColour{15, 19, 27};
inline constexpr Colour kGridColour{40, 48, 62};
inline constexpr Colour kFreeColour{52, 96, 84};       ///< free cells of the occupancy grid
inline constexpr Colour kOccupiedColour{226, 92, 72};  ///< occupied cells
inline constexpr Colour kLowColour{110, 150, 200};     ///< landmarks at ground level
inline constexpr Colour kHighColour{244, 214, 170};    ///< landmarks 6 m above the ground
inline constexpr Colour kPathColour{255, 209, 71};     ///< path, robot and camera
inline constexpr Colour kTextColour{232, 236, 242};
inline constexpr Colour kDimTextColour{150, 160, 175};

/// Pixels of one point, 1/720 of a picture's height; less in narrow pictures, at least 0.5.
[[nodiscard]] double pixelsPerPoint(const cv::Size& picture);

/// Draws text, panels and lines on a picture, with sizes in points.
class Canvas {
 public:
  /// @param picture  8-bit BGR; must outlive the canvas
  explicit Canvas(cv::Mat& picture);
  /// A canvas on a part of a picture, with the point size of the whole times `factor`.
  Canvas(cv::Mat& part, const Canvas& whole, double factor = 1.0)
      : picture_(part), scale_(whole.scale_ * factor) {}

  [[nodiscard]] cv::Mat& picture() { return picture_; }
  [[nodiscard]] cv::Size size() const { return picture_.size(); }
  /// Converts points to pixels, at least 1.
  [[nodiscard]] int px(double points) const;
  [[nodiscard]] cv::Size textSize(const std::string& text, double points) const;

  /// Text starting at the baseline point `at`; `points` is the height of capitals.
  ///
  /// @param halo  dark outline, for text without a panel
  void text(const std::string& text, cv::Point at, double points, Colour colour, bool halo = true);
  /// Darkens a rectangle as background of text.
  void panel(cv::Rect rect, double opacity = 0.62);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double points, Colour colour);
  void filled(cv::Rect rect, Colour colour);
  void outline(cv::Rect rect, Colour colour);
  /// A filled convex polygon.
  void polygon(const std::vector<Eigen::Vector2d>& corners, Colour colour);
  /// Scales an image (grey or BGR) into a rectangle; no effect if it exceeds the picture.
  void image(const cv::Mat& source, cv::Rect rect);

 private:
  cv::Mat& picture_;
  double scale_;
};

}  // namespace headway::scene
