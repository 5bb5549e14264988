// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/plot/chart.h>

#include <opencv2/core/mat.hpp>
#include <string>

// Drawing primitives of a chart. The drawing is kOversampling times as large as the final picture:
// positions are in pixels of the drawing; widths, radii and text scales in those of the picture.

namespace headway::plot {

inline constexpr int kOversampling = 2;
inline constexpr Colour kInk{40, 40, 40};
inline constexpr Colour kGrid{226, 226, 226};

/// A polyline drawn segment by segment; the dash pattern continues from one segment to the next.
class Stroke {
 public:
  Stroke(Colour colour, double width_px, LineStyle style = LineStyle::kSolid)
      : colour_(colour), width_px_(width_px), style_(style) {}

  void draw(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b);

 private:
  void drawSegment(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b) const;
  void drawDashes(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b);

  Colour colour_;
  double width_px_;
  LineStyle style_;
  double phase_ = 0.0;  ///< length drawn so far
};

void drawDisc(cv::Mat& image, const cv::Point2d& centre, double radius_px, Colour colour);
void drawBar(cv::Mat& image, const cv::Point2d& corner, const cv::Point2d& opposite, Colour colour);
void drawFrame(cv::Mat& image, const cv::Rect& box, Colour colour);

/// @param anchor  at half the height of the text
/// @param align   horizontal position of the anchor: 0 left end, 0.5 centre, 1 right end
/// @param scale   of the font; capitals are 22 px high at 1
void drawText(cv::Mat& image, const std::string& text, const cv::Point2d& anchor, double align,
              double scale, Colour colour);
/// Text rotated by 90 degrees counterclockwise, on white.
void drawTextUpwards(cv::Mat& image, const std::string& text, const cv::Point2d& centre,
                     double scale, Colour colour);
/// Width of the text in pixels of the drawing.
[[nodiscard]] int textWidth(const std::string& text, double scale);

}  // namespace headway::plot
