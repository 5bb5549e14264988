#pragma once

#include <headway/core/class_colour.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::scene {

/// Draws text, panels and lines on a picture, in sizes that suit the picture's height.
class Canvas {
 public:
  explicit Canvas(cv::Mat& picture);
  /// For a part of a picture: sizes as in the whole, times `factor`.
  Canvas(cv::Mat& part, const Canvas& whole, double factor = 1.0)
      : picture_(part), scale_(whole.scale_ * factor) {}

  [[nodiscard]] cv::Mat& picture() { return picture_; }
  [[nodiscard]] cv::Size size() const { return picture_.size(); }
  /// Pixels that stand for `points` in a picture 720 high.
  [[nodiscard]] int px(double points) const;
  [[nodiscard]] cv::Size textSize(const std::string& text, double points) const;

  /// Text whose left end stands on the baseline at `at`; `points` is the height of capitals.
  /// Without `halo` it needs a panel under it.
  void text(const std::string& text, cv::Point at, double points, Colour colour, bool halo = true);
  /// Darkens a place so that what is written on it can be read.
  void panel(cv::Rect place, double opacity = 0.62);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double points, Colour colour);
  void filled(cv::Rect place, Colour colour);
  void outline(cv::Rect place, Colour colour);
  /// A filled convex polygon.
  void polygon(const std::vector<Eigen::Vector2d>& corners, Colour colour);
  /// Puts an image (grey or BGR) in a place of any size.
  void image(const cv::Mat& source, cv::Rect place);

 private:
  cv::Mat& picture_;
  double scale_;
};

}  // namespace headway::scene
