#pragma once

#include <headway/eval/chart.h>

#include <opencv2/core/mat.hpp>
#include <string>

// Lines, areas and words of a chart. It is drawn kOver times as large as its picture comes out:
// places are in pixels of the drawing; widths, radii and sizes in those of the picture.

namespace headway::eval {

inline constexpr int kOver = 2;
inline constexpr Colour kInk{40, 40, 40};
inline constexpr Colour kGrid{226, 226, 226};

[[nodiscard]] cv::Scalar bgr(Colour colour);

/// A line of several pieces; its dashes run on from one piece to the next.
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
  double phase_ = 0.0;  ///< length of the pieces so far
};

void drawDisc(cv::Mat& image, const cv::Point2d& centre, double radius_px, Colour colour);
void drawBar(cv::Mat& image, const cv::Point2d& corner, const cv::Point2d& opposite, Colour colour);
void drawFrame(cv::Mat& image, const cv::Rect& box, Colour colour);

/// @param at     on the line through the middle of their height
/// @param align  share of the words' width that stands to the left of `at`
/// @param size   of the letters: capitals are 22 px high at 1
void write(cv::Mat& image, const std::string& words, const cv::Point2d& at, double align,
           double size, Colour colour);
/// Words that read from below, on white.
void writeUpwards(cv::Mat& image, const std::string& words, const cv::Point2d& centre, double size,
                  Colour colour);
/// In pixels of the drawing.
[[nodiscard]] int widthOf(const std::string& words, double size);

}  // namespace headway::eval
