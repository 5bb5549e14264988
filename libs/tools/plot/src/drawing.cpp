// SPDX-License-Identifier: BSD-3-Clause
#include "drawing.h"

#include <headway/plot/colours.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::plot {
namespace {

constexpr int kShift = 4;  // fractional bits of OpenCV's coordinates
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

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
  return cv::getTextSize(text, kFont, scale * kOversampling, kOversampling, baseline);
}

}  // namespace

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

void drawText(cv::Mat& image, const std::string& text, const cv::Point2d& anchor, double align,
              double scale, Colour colour) {
  constexpr double kFar = 1e6;  // [px], far outside every image
  if (!(std::abs(anchor.x) < kFar && std::abs(anchor.y) < kFar)) return;
  int baseline = 0;
  const auto box = sizeOf(text, scale, &baseline);
  const cv::Point origin(static_cast<int>(anchor.x - align * box.width),
                         static_cast<int>(anchor.y + 0.5 * box.height));
  cv::putText(image, text, origin, kFont, scale * kOversampling, bgr(colour), kOversampling,
              cv::LINE_AA);
}

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

int textWidth(const std::string& text, double scale) {
  int baseline = 0;
  return sizeOf(text, scale, &baseline).width;
}

}  // namespace headway::plot
