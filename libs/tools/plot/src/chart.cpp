// SPDX-License-Identifier: BSD-3-Clause
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>
#include <headway/plot/ticks.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "drawing.h"

namespace headway::plot {
namespace {

constexpr double kGroupWidth = 0.84;  ///< of the width of a group that its bars occupy

Range widened(Range range, double margin) {
  const double size = range.size() > 0.0 ? range.size() : std::max(1.0, std::abs(range.min));
  return {range.min - margin * size, range.max + margin * size};
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
      axes_(kOversampling * 84, kOversampling * 46,
            kOversampling * (frame.width - 84 - frame.right_px),
            kOversampling * (frame.height - 46 - 62)),
      image_(kOversampling * frame.height, kOversampling * frame.width, CV_8UC3,
             cv::Scalar::all(255)) {
  frame_.x = widened(frame_.x, frame_.same_scale ? 0.04 : 0.0);
  frame_.y = widened(frame_.y, 0.04);
  if (frame_.same_scale) {
    const double unit = std::max(frame_.x.size() / axes_.width, frame_.y.size() / axes_.height);
    frame_.x = around(frame_.x, unit * axes_.width);
    frame_.y = around(frame_.y, unit * axes_.height);
  }
  drawGrid();
}

cv::Point2d Chart::toPixel(const Eigen::Vector2d& point) const {
  return {axes_.x + (point.x() - frame_.x.min) / frame_.x.size() * axes_.width,
          axes_.y + axes_.height - (point.y() - frame_.y.min) / frame_.y.size() * axes_.height};
}

void Chart::drawColumns() {
  const auto label = [this](double x, const std::string& text) {
    drawText(image_, text, toPixel({x, frame_.y.min}) + cv::Point2d(0, 16 * kOversampling), 0.5,
             0.45, kInk);
  };
  const auto rule = [this](double x) {
    Stroke(kGrid, 1.0).draw(image_, toPixel({x, frame_.y.min}), toPixel({x, frame_.y.max}));
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
    const auto left = toPixel({frame_.x.min, y});
    Stroke(kGrid, 1.0).draw(image_, left, toPixel({frame_.x.max, y}));
    drawText(image_, tickText(y, step), left - cv::Point2d(8 * kOversampling, 0), 1.0, 0.45, kInk);
  }
  drawFrame(image_, axes_, kInk);
  const double middle = axes_.x + 0.5 * axes_.width;
  drawText(image_, frame_.title, {middle, 24.0 * kOversampling}, 0.5, 0.65, kInk);
  drawText(image_, frame_.x_label, {middle, (frame_.height - 20.0) * kOversampling}, 0.5, 0.5,
           kInk);
  drawTextUpwards(image_, frame_.y_label, {20.0 * kOversampling, axes_.y + 0.5 * axes_.height}, 0.5,
                  kInk);
}

void Chart::line(const std::vector<Eigen::Vector2d>& points, Colour colour, double width_px,
                 LineStyle style) {
  cv::Mat inside = image_(axes_);
  const cv::Point2d corner = axes_.tl();
  Stroke stroke(colour, width_px, style);
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (!points[i - 1].allFinite() || !points[i].allFinite()) continue;
    stroke.draw(inside, toPixel(points[i - 1]) - corner, toPixel(points[i]) - corner);
  }
}

void Chart::dot(const Eigen::Vector2d& point, Colour colour, double radius_px) {
  if (!point.allFinite()) return;
  cv::Mat inside = image_(axes_);
  drawDisc(inside, toPixel(point) - cv::Point2d(axes_.tl()), radius_px, colour);
}

void Chart::ring(const Eigen::Vector2d& point, Colour colour, double radius_px) {
  dot(point, colour, radius_px);
  dot(point, {255, 255, 255}, 0.55 * radius_px);
}

void Chart::bar(double x_from, double x_to, double y, Colour colour) {
  drawBar(image_, toPixel({x_from, std::max(0.0, frame_.y.min)}), toPixel({x_to, y}), colour);
}

void Chart::text(const Eigen::Vector2d& point, const std::string& text, Colour colour) {
  drawText(image_, text, toPixel(point) + cv::Point2d(8 * kOversampling, -8 * kOversampling), 0.0,
           0.45, colour);
}

void Chart::ramp(const std::string& label, double max) {
  const int left = axes_.x + axes_.width + 24 * kOversampling;
  const int width = 16 * kOversampling;
  for (int row = 0; row < axes_.height; ++row) {
    const double value = 1.0 - static_cast<double>(row) / axes_.height;
    cv::line(image_, {left, axes_.y + row}, {left + width, axes_.y + row}, bgr(rampColour(value)));
  }
  const double step = tickStep(max, 6.0);
  for (double value = 0.0; value <= max * (1 + 1e-9); value += step) {
    const double y = axes_.y + axes_.height * (1.0 - value / max);
    drawText(image_, tickText(value, step), {left + width + 6.0 * kOversampling, y}, 0.0, 0.42,
             kInk);
  }
  drawTextUpwards(image_, label,
                  {(frame_.width - 12.0) * kOversampling, axes_.y + 0.5 * axes_.height}, 0.48,
                  kInk);
}

cv::Mat Chart::picture() const {
  cv::Mat large = image_.clone();
  drawLegend(large);
  cv::Mat result;
  cv::resize(large, result, {frame_.width, frame_.height}, 0, 0, cv::INTER_AREA);
  return result;
}

cv::Mat drawBars(const BarChart& bars) {
  ChartFrame frame{bars.title, "", bars.y_label, {0.0, 1.0}, {0.0, 0.0}};
  frame.x.max = std::max(1.0, static_cast<double>(bars.groups.size()));
  frame.height = 460;
  frame.right_px = kLegendWidth_px;
  frame.legend_beside = true;  // bars may fill every corner
  frame.x_names = bars.groups;
  for (const auto& series : bars.series) {
    for (const double value : series.values) frame.y.include(value);
  }
  if (!(frame.y.max > 0.0)) frame.y.max = 1.0;
  Chart chart(frame);
  const double width =
      kGroupWidth / static_cast<double>(std::max<std::size_t>(1, bars.series.size()));
  for (std::size_t s = 0; s < bars.series.size(); ++s) {
    const auto& [name, values] = bars.series[s];
    for (std::size_t g = 0; g < values.size(); ++g) {
      if (!std::isfinite(values[g])) continue;
      const double left =
          static_cast<double>(g) + 0.5 * (1.0 - kGroupWidth) + width * static_cast<double>(s);
      chart.bar(left, left + 0.92 * width, values[g], categoryColour(s));
    }
    chart.legend(name, categoryColour(s));
  }
  return chart.picture();
}

cv::Mat stacked(const std::vector<cv::Mat>& pictures) {
  cv::Mat result;
  cv::vconcat(pictures, result);
  return result;
}

}  // namespace headway::plot
