// SPDX-License-Identifier: BSD-3-Clause
// Charts with axes, lines, bars and a legend.
#pragma once

#include <headway/core/object_class.h>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::plot {

/// Smallest step of 1, 2 or 5 times a power of ten that divides `range` into at most `max_parts`.
[[nodiscard]] double tickStep(double range, double max_parts);

/// Largest length of 1, 2 or 5 times a power of ten that does not exceed `max_length`: for scale
/// bars.
///
/// @param max_length  above 0
[[nodiscard]] double scaleBarLength(double max_length);

/// A tick's value with as many decimals as its step needs.
[[nodiscard]] std::string tickText(double value, double step);

/// A closed interval of an axis.
struct Range {
  double min = 0.0;
  double max = 1.0;
  void include(double value);  ///< extends the range; ignores values that are not finite
  [[nodiscard]] double size() const { return max - min; }
};

/// Smallest range that contains one coordinate (0 or 1) of all finite points; [0, 1] if there are
/// none.
[[nodiscard]] Range rangeOf(const std::vector<Eigen::Vector2d>& points, int coordinate);

enum class LineStyle { kSolid, kDashed, kDotted };

/// Width reserved to the right of the axes for Chart::ramp() [px].
inline constexpr int kRampWidth_px = 120;
/// Width reserved to the right of the axes for a legend beside them, names of up to 17 letters.
inline constexpr int kLegendWidth_px = 236;

/// Axes and layout of a chart.
struct ChartFrame {
  std::string title;
  std::string x_label;
  std::string y_label;
  Range x;
  Range y;
  bool same_scale = false;     ///< equal scale along both axes, for maps
  int width = 1200;            ///< [px]
  int height = 760;            ///< [px]
  int right_px = 24;           ///< width right of the axes; ramp() needs kRampWidth_px
  bool legend_beside = false;  ///< legend right of the axes instead of in an empty corner
  std::vector<std::string> x_names = {};  ///< category names of [0, 1], [1, 2] ... along x
};

/// Raster chart with axes, lines, dots, bars and a legend; the same calls give the same bytes.
///
/// Hand-written because OpenCV's plot module draws a single curve without labels or a legend.
/// Drawn at twice the output size and averaged down. Points that are not finite interrupt a line.
///
///     Chart chart({"Error", "time [s]", "error [m]", {0, 10}, {0, 0.2}});
///     chart.line(points, categoryColour(0));
///     chart.legend("headway", categoryColour(0));
///     cv::imwrite("error.png", chart.picture());
class Chart {
 public:
  explicit Chart(const ChartFrame& frame);

  // Positions are in axis units, widths and radii in pixels of the picture.
  void line(const std::vector<Eigen::Vector2d>& points, Colour colour, double width_px = 2.0,
            LineStyle style = LineStyle::kSolid);
  void dot(const Eigen::Vector2d& point, Colour colour, double radius_px = 4.0);
  void ring(const Eigen::Vector2d& point, Colour colour, double radius_px = 6.0);
  void bar(double x_from, double x_to, double y, Colour colour);  ///< from y = 0
  void text(const Eigen::Vector2d& point, const std::string& text, Colour colour = {});

  /// Adds a legend entry. The legend is placed in the corner with the least ink, or beside the
  /// axes.
  void legend(const std::string& name, Colour colour, LineStyle style = LineStyle::kSolid);
  /// Draws the scale of rampColour() from 0 to `max` right of the axes.
  void ramp(const std::string& label, double max);

  /// The current picture, height x width, 8-bit BGR.
  [[nodiscard]] cv::Mat picture() const;

 private:
  struct Entry {
    std::string name;
    Colour colour;
    LineStyle style;
  };
  [[nodiscard]] cv::Point2d toPixel(const Eigen::Vector2d& point) const;
  void drawColumns();
  void drawGrid();
  void drawLegend(cv::Mat& image) const;

  ChartFrame frame_;
  cv::Rect axes_;  ///< area inside the axes [px of image_]
  cv::Mat image_;
  std::vector<Entry> entries_;
};

/// Bars of one colour.
struct BarSeries {
  std::string name;
  std::vector<double> values;  ///< one per group; values that are not finite leave a gap
};

/// Grouped bars.
struct BarChart {
  std::string title;
  std::string y_label;
  std::vector<std::string> groups;
  std::vector<BarSeries> series;
};

/// Draws the bars upwards from zero. 8-bit BGR.
[[nodiscard]] cv::Mat drawBars(const BarChart& bars);

/// Concatenates pictures of equal width vertically.
[[nodiscard]] cv::Mat stacked(const std::vector<cv::Mat>& pictures);

}  // namespace headway::plot
