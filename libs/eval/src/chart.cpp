#include <headway/eval/chart.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "axis_ticks.h"
#include "strokes.h"

namespace headway::eval {
namespace {

Range widened(Range range, double share) {
  const double size = range.size() > 0.0 ? range.size() : std::max(1.0, std::abs(range.min));
  return {range.min - share * size, range.max + share * size};
}

Range around(Range range, double size) {
  const double middle = 0.5 * (range.min + range.max);
  return {middle - 0.5 * size, middle + 0.5 * size};
}

}  // namespace

void Range::include(double value) {
  if (!std::isfinite(value)) return;
  min = std::min(min, value);
  max = std::max(max, value);
}

Range rangeOf(const std::vector<Eigen::Vector2d>& points, int coordinate) {
  const auto first =
      std::find_if(points.begin(), points.end(), [](const auto& p) { return p.allFinite(); });
  if (first == points.end()) return {};
  Range range{(*first)[coordinate], (*first)[coordinate]};
  for (const auto& point : points) range.include(point[coordinate]);
  return range;
}

Chart::Chart(const ChartFrame& frame)
    : frame_(frame),
      plot_(kOver * 84, kOver * 46, kOver * (frame.width - 84 - frame.right_px),
            kOver * (frame.height - 46 - 62)),
      image_(kOver * frame.height, kOver * frame.width, CV_8UC3, cv::Scalar::all(255)) {
  frame_.x = widened(frame_.x, frame_.same_scale ? 0.04 : 0.0);
  frame_.y = widened(frame_.y, 0.04);
  if (frame_.same_scale) {
    const double unit = std::max(frame_.x.size() / plot_.width, frame_.y.size() / plot_.height);
    frame_.x = around(frame_.x, unit * plot_.width);
    frame_.y = around(frame_.y, unit * plot_.height);
  }
  drawGrid();
}

cv::Point2d Chart::place(const Eigen::Vector2d& point) const {
  return {plot_.x + (point.x() - frame_.x.min) / frame_.x.size() * plot_.width,
          plot_.y + plot_.height - (point.y() - frame_.y.min) / frame_.y.size() * plot_.height};
}

void Chart::drawColumns() {
  const auto label = [this](double x, const std::string& words) {
    write(image_, words, place({x, frame_.y.min}) + cv::Point2d(0, 16 * kOver), 0.5, 0.45, kInk);
  };
  const auto rule = [this](double x) {
    Stroke(kGrid, 1.0).draw(image_, place({x, frame_.y.min}), place({x, frame_.y.max}));
  };
  for (std::size_t i = 0; i < frame_.x_names.size(); ++i) {
    rule(static_cast<double>(i));
    label(static_cast<double>(i) + 0.5, frame_.x_names[i]);
  }
  if (!frame_.x_names.empty()) return;
  const double step = tickStep(frame_.x.size(), frame_.width / 130.0);
  for (double x = std::ceil(frame_.x.min / step) * step; x <= frame_.x.max; x += step) {
    rule(x);
    label(x, tickText(x, step));
  }
}

void Chart::drawGrid() {
  drawColumns();
  const double step = tickStep(frame_.y.size(), frame_.height / 90.0);
  for (double y = std::ceil(frame_.y.min / step) * step; y <= frame_.y.max; y += step) {
    const auto foot = place({frame_.x.min, y});
    Stroke(kGrid, 1.0).draw(image_, foot, place({frame_.x.max, y}));
    write(image_, tickText(y, step), foot - cv::Point2d(8 * kOver, 0), 1.0, 0.45, kInk);
  }
  drawFrame(image_, plot_, kInk);
  const double middle = plot_.x + 0.5 * plot_.width;
  write(image_, frame_.title, {middle, 24.0 * kOver}, 0.5, 0.65, kInk);
  write(image_, frame_.x_label, {middle, (frame_.height - 20.0) * kOver}, 0.5, 0.5, kInk);
  writeUpwards(image_, frame_.y_label, {20.0 * kOver, plot_.y + 0.5 * plot_.height}, 0.5, kInk);
}

void Chart::line(const std::vector<Eigen::Vector2d>& points, Colour colour, double width_px,
                 LineStyle style) {
  cv::Mat inside = image_(plot_);
  const cv::Point2d corner = plot_.tl();
  Stroke stroke(colour, width_px, style);
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (!points[i - 1].allFinite() || !points[i].allFinite()) continue;
    stroke.draw(inside, place(points[i - 1]) - corner, place(points[i]) - corner);
  }
}

void Chart::dot(const Eigen::Vector2d& point, Colour colour, double radius_px) {
  if (!point.allFinite()) return;
  cv::Mat inside = image_(plot_);
  drawDisc(inside, place(point) - cv::Point2d(plot_.tl()), radius_px, colour);
}

void Chart::ring(const Eigen::Vector2d& point, Colour colour, double radius_px) {
  dot(point, colour, radius_px);
  dot(point, {255, 255, 255}, 0.55 * radius_px);
}

void Chart::bar(double x_from, double x_to, double y, Colour colour) {
  drawBar(image_, place({x_from, std::max(0.0, frame_.y.min)}), place({x_to, y}), colour);
}

void Chart::text(const Eigen::Vector2d& point, const std::string& words, Colour colour) {
  write(image_, words, place(point) + cv::Point2d(8 * kOver, -8 * kOver), 0.0, 0.45, colour);
}

void Chart::ramp(const std::string& label, double max) {
  const int left = plot_.x + plot_.width + 24 * kOver;
  const int width = 16 * kOver;
  for (int row = 0; row < plot_.height; ++row) {
    const double value = 1.0 - static_cast<double>(row) / plot_.height;
    cv::line(image_, {left, plot_.y + row}, {left + width, plot_.y + row}, bgr(rampColour(value)));
  }
  const double step = tickStep(max, 6.0);
  for (double value = 0.0; value <= max * (1 + 1e-9); value += step) {
    const double y = plot_.y + plot_.height * (1.0 - value / max);
    write(image_, tickText(value, step), {left + width + 6.0 * kOver, y}, 0.0, 0.42, kInk);
  }
  writeUpwards(image_, label, {(frame_.width - 12.0) * kOver, plot_.y + 0.5 * plot_.height}, 0.48,
               kInk);
}

cv::Mat Chart::picture() const {
  cv::Mat large = image_.clone();
  drawLegend(large);
  cv::Mat result;
  cv::resize(large, result, {frame_.width, frame_.height}, 0, 0, cv::INTER_AREA);
  return result;
}

cv::Mat stacked(const std::vector<cv::Mat>& pictures) {
  cv::Mat result;
  cv::vconcat(pictures, result);
  return result;
}

}  // namespace headway::eval
