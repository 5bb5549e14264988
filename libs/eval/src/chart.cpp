#include <headway/eval/chart.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

namespace headway::eval {
namespace {

constexpr int kOver = 2;   // drawn this much larger
constexpr int kShift = 4;  // fractional bits of OpenCV's coordinates
constexpr Colour kInk{40, 40, 40};
constexpr Colour kGrid{226, 226, 226};
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

cv::Scalar bgr(Colour c) { return {double(c.blue), double(c.green), double(c.red)}; }

cv::Point fixed(const cv::Point2d& p) {
  // Far outside the picture the exact place does not matter, but an overflow would.
  const auto limited = [](double v) {
    return std::lround(std::clamp(v, -1e5, 1e5) * (1 << kShift));
  };
  return {static_cast<int>(limited(p.x)), static_cast<int>(limited(p.y))};
}

int pixels(double final_px) { return std::max(1, static_cast<int>(std::lround(final_px * kOver))); }

void write(cv::Mat& image, const std::string& words, cv::Point2d at, double align, double size,
           Colour colour) {
  const double scale = size * kOver;
  int baseline = 0;
  const auto box = cv::getTextSize(words, kFont, scale, kOver, &baseline);
  const cv::Point origin(static_cast<int>(at.x - align * box.width),
                         static_cast<int>(at.y + 0.5 * box.height));
  cv::putText(image, words, origin, kFont, scale, bgr(colour), kOver, cv::LINE_AA);
}

void writeUpwards(cv::Mat& image, const std::string& words, cv::Point2d centre, double size) {
  int baseline = 0;
  const auto box = cv::getTextSize(words, kFont, size * kOver, kOver, &baseline);
  cv::Mat strip(box.height + 2 * baseline + 4, box.width + 4, CV_8UC3, cv::Scalar::all(255));
  write(strip, words, {0.5 * strip.cols, 0.5 * strip.rows}, 0.5, size, kInk);
  cv::rotate(strip, strip, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect wanted(static_cast<int>(centre.x) - strip.cols / 2,
                        static_cast<int>(centre.y) - strip.rows / 2, strip.cols, strip.rows);
  const cv::Rect inside = wanted & cv::Rect({0, 0}, image.size());
  strip(inside - wanted.tl()).copyTo(image(inside));
}

/// Step of 1, 2 or 5 times a power of ten that cuts `range` into about `parts`.
double niceStep(double range, double parts) {
  const double rough = range / parts;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10.0 * power;
}

std::string tickText(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals,
                std::abs(value) < 1e-9 * step ? 0.0 : value);
  return text.data();
}

Range widened(Range range, double share) {
  const double size = range.size() > 0.0 ? range.size() : std::max(1.0, std::abs(range.min));
  return {range.min - share * size, range.max + share * size};
}

Range around(Range range, double size) {
  const double middle = 0.5 * (range.min + range.max);
  return {middle - 0.5 * size, middle + 0.5 * size};
}

void drawSegment(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b, Colour colour,
                 double width_px) {
  cv::line(image, fixed(a), fixed(b), bgr(colour), pixels(width_px), cv::LINE_AA, kShift);
}

/// Draws the parts of a line that its dashes cover; `phase` runs on from piece to piece.
void drawDashes(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b, Colour colour,
                double width_px, LineStyle style, double& phase) {
  const double on = (style == LineStyle::kDashed ? 9.0 : 2.0) * kOver;
  const double period = on + 6.0 * kOver;
  const double length = cv::norm(b - a);
  for (double at = 0.0; at < length;) {
    const double in_period = std::fmod(phase + at, period);
    const double end = std::min(length, at + (in_period < on ? on : period) - in_period + 1e-6);
    if (in_period < on) {
      drawSegment(image, a + (b - a) * (at / length), a + (b - a) * (end / length), colour,
                  width_px);
    }
    at = end;
  }
  phase += length;
}

/// Place for a box of that size in the corner of the plot where least is drawn.
cv::Rect emptiestCorner(const cv::Mat& image, const cv::Rect& plot, cv::Size size, int margin) {
  const int left = plot.x + margin;
  const int right = plot.x + plot.width - size.width - margin;
  const int top = plot.y + margin;
  const int bottom = plot.y + plot.height - size.height - margin;
  cv::Rect best;
  int least = -1;
  for (const auto& corner : {cv::Point(right, top), {left, top}, {right, bottom}, {left, bottom}}) {
    const cv::Rect box(corner, size);
    cv::Mat background;
    const cv::Mat part = image(box & cv::Rect({0, 0}, image.size()));
    cv::inRange(part, cv::Scalar::all(kGrid.red - 4), cv::Scalar::all(255), background);
    const int ink = static_cast<int>(part.total()) - cv::countNonZero(background);
    if (least >= 0 && ink >= least) continue;
    least = ink;
    best = box;
  }
  return best;
}

}  // namespace

Colour categoryColour(std::size_t number) {
  static constexpr std::array<Colour, 8> kColours = {{{0, 114, 178},
                                                      {213, 94, 0},
                                                      {0, 158, 115},
                                                      {204, 121, 167},
                                                      {230, 159, 0},
                                                      {86, 180, 233},
                                                      {120, 94, 60},
                                                      {90, 90, 90}}};
  return kColours[number % kColours.size()];
}

Colour rampColour(double value) {
  static constexpr std::array<Colour, 5> kStops = {
      {{38, 84, 168}, {30, 150, 170}, {90, 175, 70}, {235, 160, 30}, {200, 30, 40}}};
  const double at = std::clamp(value, 0.0, 1.0) * (kStops.size() - 1);
  const auto i = std::min(kStops.size() - 2, static_cast<std::size_t>(at));
  const double t = at - static_cast<double>(i);
  const auto mix = [t](std::uint8_t a, std::uint8_t b) {
    return static_cast<std::uint8_t>(std::lround((1.0 - t) * a + t * b));
  };
  const Colour a = kStops[i];
  const Colour b = kStops[i + 1];
  return {mix(a.red, b.red), mix(a.green, b.green), mix(a.blue, b.blue)};
}

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
    drawSegment(image_, place({x, frame_.y.min}), place({x, frame_.y.max}), kGrid, 1.0);
  };
  for (std::size_t i = 0; i < frame_.x_names.size(); ++i) {
    rule(static_cast<double>(i));
    label(static_cast<double>(i) + 0.5, frame_.x_names[i]);
  }
  if (!frame_.x_names.empty()) return;
  const double step = niceStep(frame_.x.size(), frame_.width / 130.0);
  for (double x = std::ceil(frame_.x.min / step) * step; x <= frame_.x.max; x += step) {
    rule(x);
    label(x, tickText(x, step));
  }
}

void Chart::drawGrid() {
  drawColumns();
  const double step = niceStep(frame_.y.size(), frame_.height / 90.0);
  for (double y = std::ceil(frame_.y.min / step) * step; y <= frame_.y.max; y += step) {
    const auto foot = place({frame_.x.min, y});
    drawSegment(image_, foot, place({frame_.x.max, y}), kGrid, 1.0);
    write(image_, tickText(y, step), foot - cv::Point2d(8 * kOver, 0), 1.0, 0.45, kInk);
  }
  cv::rectangle(image_, plot_, bgr(kInk), kOver, cv::LINE_AA);
  const double middle = plot_.x + 0.5 * plot_.width;
  write(image_, frame_.title, {middle, 24.0 * kOver}, 0.5, 0.65, kInk);
  write(image_, frame_.x_label, {middle, (frame_.height - 20.0) * kOver}, 0.5, 0.5, kInk);
  writeUpwards(image_, frame_.y_label, {20.0 * kOver, plot_.y + 0.5 * plot_.height}, 0.5);
}

void Chart::line(const std::vector<Eigen::Vector2d>& points, Colour colour, double width_px,
                 LineStyle style) {
  cv::Mat inside = image_(plot_);
  const cv::Point2d corner = plot_.tl();
  double phase = 0.0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (!points[i - 1].allFinite() || !points[i].allFinite()) continue;
    const auto a = place(points[i - 1]) - corner;
    const auto b = place(points[i]) - corner;
    if (style == LineStyle::kSolid) {
      drawSegment(inside, a, b, colour, width_px);
    } else {
      drawDashes(inside, a, b, colour, width_px, style, phase);
    }
  }
}

void Chart::dot(const Eigen::Vector2d& point, Colour colour, double radius_px) {
  if (!point.allFinite()) return;
  cv::Mat inside = image_(plot_);
  cv::circle(inside, fixed(place(point) - cv::Point2d(plot_.tl())), pixels(radius_px) << kShift,
             bgr(colour), cv::FILLED, cv::LINE_AA, kShift);
}

void Chart::ring(const Eigen::Vector2d& point, Colour colour, double radius_px) {
  dot(point, colour, radius_px);
  dot(point, {255, 255, 255}, 0.55 * radius_px);
}

void Chart::bar(double x_from, double x_to, double y, Colour colour) {
  const auto a = place({x_from, std::max(0.0, frame_.y.min)});
  const auto b = place({x_to, y});
  cv::rectangle(image_, fixed(a), fixed(b), bgr(colour), cv::FILLED, cv::LINE_AA, kShift);
}

void Chart::text(const Eigen::Vector2d& point, const std::string& words, Colour colour) {
  write(image_, words, place(point) + cv::Point2d(8 * kOver, -8 * kOver), 0.0, 0.45, colour);
}

void Chart::legend(const std::string& name, Colour colour, LineStyle style) {
  entries_.push_back({name, colour, style});
}

void Chart::ramp(const std::string& label, double max) {
  const int left = plot_.x + plot_.width + 24 * kOver;
  const int width = 16 * kOver;
  for (int row = 0; row < plot_.height; ++row) {
    const double value = 1.0 - static_cast<double>(row) / plot_.height;
    cv::line(image_, {left, plot_.y + row}, {left + width, plot_.y + row}, bgr(rampColour(value)));
  }
  const double step = niceStep(max, 6.0);
  for (double value = 0.0; value <= max * (1 + 1e-9); value += step) {
    const double y = plot_.y + plot_.height * (1.0 - value / max);
    write(image_, tickText(value, step), {left + width + 6.0 * kOver, y}, 0.0, 0.42, kInk);
  }
  writeUpwards(image_, label, {(frame_.width - 12.0) * kOver, plot_.y + 0.5 * plot_.height}, 0.48);
}

void Chart::drawLegend(cv::Mat& image) const {
  if (entries_.empty()) return;
  int widest = 0;
  for (const auto& entry : entries_) {
    int baseline = 0;
    widest =
        std::max(widest, cv::getTextSize(entry.name, kFont, 0.5 * kOver, kOver, &baseline).width);
  }
  const int row = 22 * kOver;
  const int sample = 34 * kOver;
  const int margin = 12 * kOver;
  const cv::Size size(widest + sample + 3 * margin,
                      row * static_cast<int>(entries_.size()) + margin);
  const cv::Rect box = frame_.legend_beside
                           ? cv::Rect({plot_.x + plot_.width + margin, plot_.y}, size)
                           : emptiestCorner(image, plot_, size, margin);
  cv::rectangle(image, box, cv::Scalar::all(255), cv::FILLED);
  cv::rectangle(image, box, bgr(kGrid), kOver, cv::LINE_AA);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const double y = box.y + 0.5 * margin + row * (static_cast<double>(i) + 0.5);
    const cv::Point2d from(box.x + margin, y);
    const cv::Point2d to(from.x + sample, y);
    double phase = 0.0;
    if (entries_[i].style == LineStyle::kSolid)
      drawSegment(image, from, to, entries_[i].colour, 3);
    else
      drawDashes(image, from, to, entries_[i].colour, 3, entries_[i].style, phase);
    write(image, entries_[i].name, {to.x + margin, y}, 0.0, 0.5, kInk);
  }
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
