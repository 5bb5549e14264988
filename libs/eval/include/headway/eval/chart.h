#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::eval {

struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

/// Colours that are told apart in print and by most colour-blind readers; the number may be any.
///
/// @see Okabe & Ito 2008, "Color universal design"
[[nodiscard]] Colour categoryColour(std::size_t number);

/// Blue (0) over green to red (1); values outside are drawn as the nearer end.
[[nodiscard]] Colour rampColour(double value);

struct Range {
  double min = 0.0;
  double max = 1.0;
  void include(double value);  ///< what is not finite is left out
  [[nodiscard]] double size() const { return max - min; }
};

/// Smallest range around the values of one coordinate (0 or 1); [0, 1] if there are none.
[[nodiscard]] Range rangeOf(const std::vector<Eigen::Vector2d>& points, int coordinate);

enum class LineStyle { kSolid, kDashed, kDotted };

/// Room to the right of the axes that Chart::ramp() needs [px].
inline constexpr int kRampRoom_px = 120;
/// The same for a legend beside the axes, names of up to 17 letters.
inline constexpr int kLegendRoom_px = 236;

/// What a chart is drawn on.
struct ChartFrame {
  std::string title;
  std::string x_label;
  std::string y_label;
  Range x;
  Range y;
  bool same_scale = false;     ///< one unit is as long along x as along y: maps
  int width = 1200;            ///< [px]
  int height = 760;            ///< [px]
  int right_px = 24;           ///< room to the right of the axes; ramp() needs kRampRoom_px
  bool legend_beside = false;  ///< the legend stands in that room, not in an empty corner
  std::vector<std::string> x_names = {};  ///< instead of numbers: names of [0, 1], [1, 2] ...
};

/// A picture with axes, lines, dots and a legend; the same calls give the same bytes.
///
/// Drawn at twice its size and averaged down. Points that are not finite break a line.
///
///     Chart chart({"Error", "time [s]", "error [m]", {0, 10}, {0, 0.2}});
///     chart.line(points, categoryColour(0));
///     chart.legend("ours", categoryColour(0));
///     cv::imwrite("error.png", chart.picture());
class Chart {
 public:
  explicit Chart(const ChartFrame& frame);

  void line(const std::vector<Eigen::Vector2d>& points, Colour colour, double width_px = 2.0,
            LineStyle style = LineStyle::kSolid);
  void dot(const Eigen::Vector2d& point, Colour colour, double radius_px = 4.0);
  void ring(const Eigen::Vector2d& point, Colour colour, double radius_px = 6.0);
  void bar(double x_from, double x_to, double y, Colour colour);  ///< from y = 0
  void text(const Eigen::Vector2d& point, const std::string& words, Colour colour = {});

  /// Adds one entry to the legend, which stands in the corner where least is drawn,
  /// or beside the axes.
  void legend(const std::string& name, Colour colour, LineStyle style = LineStyle::kSolid);
  /// Explains rampColour() to the right of the axes.
  void ramp(const std::string& label, double max);

  /// The picture as it is now, 8-bit BGR.
  [[nodiscard]] cv::Mat picture() const;

 private:
  struct Entry {
    std::string name;
    Colour colour;
    LineStyle style;
  };
  [[nodiscard]] cv::Point2d place(const Eigen::Vector2d& point) const;
  void drawColumns();
  void drawGrid();
  void drawLegend(cv::Mat& image) const;

  ChartFrame frame_;
  cv::Rect plot_;  ///< inside the axes
  cv::Mat image_;
  std::vector<Entry> entries_;
};

/// Pictures of one width under each other.
[[nodiscard]] cv::Mat stacked(const std::vector<cv::Mat>& pictures);

}  // namespace headway::eval
