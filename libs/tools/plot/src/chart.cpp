// SPDX-License-Identifier: BSD-3-Clause
// Charts with axes, lines, bars and a legend.
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>
#include <string>

namespace headway::plot {

double tickStep(double range, double max_parts) {
  const double min_step = range / max_parts;
  const double power = std::pow(10.0, std::floor(std::log10(min_step)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= min_step) return factor * power;
  }
  return 10.0 * power;
}

double scaleBarLength(double max_length) {
  const double power = std::pow(10.0, std::floor(std::log10(max_length)));
  for (const double factor : {5.0, 2.0}) {
    if (factor * power <= max_length) return factor * power;
  }
  return power;
}

std::string tickText(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const double shown = std::abs(value) < 1e-9 * step ? 0.0 : value;  // no "-0.0"
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, shown);
  return text.data();
}

// Drawing primitives of a chart. The drawing is kOversampling times as large as the final picture:
// positions are in pixels of the drawing; widths, radii and text scales in those of the picture.

namespace {

constexpr int kOversampling = 2;
constexpr Colour kInk{40, 40, 40};
constexpr Colour kGrid{226, 226, 226};

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

constexpr int kShift = 4;  // fractional bits of OpenCV's coordinates

cv::Point fixedPoint(const cv::Point2d& p) {
  // Clamped: the exact position far outside the picture is irrelevant, an overflow is not.
  const auto limited = [](double v) {
    return std::lround(std::clamp(v, -1e5, 1e5) * (1 << kShift));
  };
  return {static_cast<int>(limited(p.x)), static_cast<int>(limited(p.y))};
}

int pixels(double final_px) {
  return std::max(1, static_cast<int>(std::lround(final_px * kOversampling)));
}

cv::Size sizeOf(const std::string& text, double scale, int* baseline) {
  return cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, scale * kOversampling, kOversampling,
                         baseline);
}

void Stroke::draw(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b) {
  if (style_ == LineStyle::kSolid) {
    drawSegment(image, a, b);
  } else {
    drawDashes(image, a, b);
  }
}

void Stroke::drawSegment(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b) const {
  cv::line(image, fixedPoint(a), fixedPoint(b), bgr(colour_), pixels(width_px_), cv::LINE_AA,
           kShift);
}

void Stroke::drawDashes(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b) {
  const double on = (style_ == LineStyle::kDashed ? 9.0 : 2.0) * kOversampling;
  const double period = on + 6.0 * kOversampling;
  const double length = cv::norm(b - a);
  for (double from = 0.0; from < length;) {
    const double in_period = std::fmod(phase_ + from, period);
    const double end = std::min(length, from + (in_period < on ? on : period) - in_period + 1e-6);
    if (in_period < on) {
      drawSegment(image, a + (b - a) * (from / length), a + (b - a) * (end / length));
    }
    from = end;
  }
  phase_ += length;
}

void drawDisc(cv::Mat& image, const cv::Point2d& centre, double radius_px, Colour colour) {
  cv::circle(image, fixedPoint(centre), pixels(radius_px) << kShift, bgr(colour), cv::FILLED,
             cv::LINE_AA, kShift);
}

void drawBar(cv::Mat& image, const cv::Point2d& corner, const cv::Point2d& opposite,
             Colour colour) {
  cv::rectangle(image, fixedPoint(corner), fixedPoint(opposite), bgr(colour), cv::FILLED,
                cv::LINE_AA, kShift);
}

void drawFrame(cv::Mat& image, const cv::Rect& box, Colour colour) {
  cv::rectangle(image, box, bgr(colour), kOversampling, cv::LINE_AA);
}

/// @param anchor  at half the height of the text
/// @param align   horizontal position of the anchor: 0 left end, 0.5 centre, 1 right end
/// @param scale   of the font; capitals are 22 px high at 1
void drawText(cv::Mat& image, const std::string& text, const cv::Point2d& anchor, double align,
              double scale, Colour colour) {
  if (!(std::max(std::abs(anchor.x), std::abs(anchor.y)) < 1e6)) return;  // outside every image
  int baseline = 0;
  const auto box = sizeOf(text, scale, &baseline);
  const cv::Point origin(static_cast<int>(anchor.x - align * box.width),
                         static_cast<int>(anchor.y + 0.5 * box.height));
  cv::putText(image, text, origin, cv::FONT_HERSHEY_SIMPLEX, scale * kOversampling, bgr(colour),
              kOversampling, cv::LINE_AA);
}

/// Text rotated by 90 degrees counterclockwise, on white.
void drawTextUpwards(cv::Mat& image, const std::string& text, const cv::Point2d& centre,
                     double scale, Colour colour) {
  int baseline = 0;
  const auto box = sizeOf(text, scale, &baseline);
  cv::Mat strip(box.height + 2 * baseline + 4, box.width + 4, CV_8UC3, cv::Scalar::all(255));
  drawText(strip, text, {0.5 * strip.cols, 0.5 * strip.rows}, 0.5, scale, colour);
  cv::rotate(strip, strip, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect wanted(static_cast<int>(centre.x) - strip.cols / 2,
                        static_cast<int>(centre.y) - strip.rows / 2, strip.cols, strip.rows);
  const cv::Rect inside = wanted & cv::Rect({0, 0}, image.size());
  strip(inside - wanted.tl()).copyTo(image(inside));
}

/// Width of the text in pixels of the drawing.
int textWidth(const std::string& text, double scale) {
  int baseline = 0;
  return sizeOf(text, scale, &baseline).width;
}

constexpr double kTextScale = 0.5;
constexpr int kSampleLength = 34 * kOversampling;  // of the line before a name
constexpr int kMargin = 12 * kOversampling;

/// Rectangle of the given size in the corner of the axes with the fewest non-background pixels.
cv::Rect emptiestCorner(const cv::Mat& image, const cv::Rect& axes, cv::Size size) {
  const int left = axes.x + kMargin;
  const int right = axes.x + axes.width - size.width - kMargin;
  const int top = axes.y + kMargin;
  const int bottom = axes.y + axes.height - size.height - kMargin;
  cv::Rect best;
  int min_ink = -1;
  for (const auto& corner : {cv::Point(right, top), {left, top}, {right, bottom}, {left, bottom}}) {
    const cv::Rect box(corner, size);
    cv::Mat background;
    const cv::Mat part = image(box & cv::Rect({0, 0}, image.size()));
    cv::inRange(part, cv::Scalar::all(kGrid.red - 4), cv::Scalar::all(255), background);
    const int ink = static_cast<int>(part.total()) - cv::countNonZero(background);
    if (min_ink >= 0 && ink >= min_ink) continue;
    min_ink = ink;
    best = box;
  }
  return best;
}

}  // namespace

void Chart::legend(const std::string& name, Colour colour, LineStyle style) {
  entries_.push_back({name, colour, style});
}

void Chart::drawLegend(cv::Mat& image) const {
  if (entries_.empty()) return;
  int max_width = 0;
  for (const auto& entry : entries_)
    max_width = std::max(max_width, textWidth(entry.name, kTextScale));
  const int row = 22 * kOversampling;
  const cv::Size size(max_width + kSampleLength + 3 * kMargin,
                      row * static_cast<int>(entries_.size()) + kMargin);
  const cv::Rect box = frame_.legend_beside
                           ? cv::Rect({axes_.x + axes_.width + kMargin, axes_.y}, size)
                           : emptiestCorner(image, axes_, size);
  cv::rectangle(image, box, cv::Scalar::all(255), cv::FILLED);
  drawFrame(image, box, kGrid);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const double y = box.y + 0.5 * kMargin + row * (static_cast<double>(i) + 0.5);
    const cv::Point2d from(box.x + kMargin, y);
    const cv::Point2d to(from.x + kSampleLength, y);
    Stroke(entries_[i].colour, 3.0, entries_[i].style).draw(image, from, to);
    drawText(image, entries_[i].name, {to.x + kMargin, y}, 0.0, kTextScale, kInk);
  }
}

namespace {

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
  const double group = 0.84;  // of a group's width, that its bars occupy
  const double width = group / static_cast<double>(std::max<std::size_t>(1, bars.series.size()));
  for (std::size_t s = 0; s < bars.series.size(); ++s) {
    const auto& [name, values] = bars.series[s];
    for (std::size_t g = 0; g < values.size(); ++g) {
      if (!std::isfinite(values[g])) continue;
      const double left =
          static_cast<double>(g) + 0.5 * (1.0 - group) + width * static_cast<double>(s);
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
