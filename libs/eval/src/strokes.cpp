#include "strokes.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::eval {
namespace {

constexpr int kShift = 4;  // fractional bits of OpenCV's coordinates
constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;

cv::Point fixed(const cv::Point2d& p) {
  // Far outside the picture the exact place does not matter, but an overflow would.
  const auto limited = [](double v) {
    return std::lround(std::clamp(v, -1e5, 1e5) * (1 << kShift));
  };
  return {static_cast<int>(limited(p.x)), static_cast<int>(limited(p.y))};
}

int pixels(double final_px) { return std::max(1, static_cast<int>(std::lround(final_px * kOver))); }

cv::Size sizeOf(const std::string& words, double size, int* baseline) {
  return cv::getTextSize(words, kFont, size * kOver, kOver, baseline);
}

}  // namespace

cv::Scalar bgr(Colour colour) {
  return {double(colour.blue), double(colour.green), double(colour.red)};
}

void Stroke::draw(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b) {
  if (style_ == LineStyle::kSolid) {
    drawSegment(image, a, b);
  } else {
    drawDashes(image, a, b);
  }
}

void Stroke::drawSegment(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b) const {
  cv::line(image, fixed(a), fixed(b), bgr(colour_), pixels(width_px_), cv::LINE_AA, kShift);
}

void Stroke::drawDashes(cv::Mat& image, const cv::Point2d& a, const cv::Point2d& b) {
  const double on = (style_ == LineStyle::kDashed ? 9.0 : 2.0) * kOver;
  const double period = on + 6.0 * kOver;
  const double length = cv::norm(b - a);
  for (double at = 0.0; at < length;) {
    const double in_period = std::fmod(phase_ + at, period);
    const double end = std::min(length, at + (in_period < on ? on : period) - in_period + 1e-6);
    if (in_period < on) {
      drawSegment(image, a + (b - a) * (at / length), a + (b - a) * (end / length));
    }
    at = end;
  }
  phase_ += length;
}

void drawDisc(cv::Mat& image, const cv::Point2d& centre, double radius_px, Colour colour) {
  cv::circle(image, fixed(centre), pixels(radius_px) << kShift, bgr(colour), cv::FILLED,
             cv::LINE_AA, kShift);
}

void drawBar(cv::Mat& image, const cv::Point2d& corner, const cv::Point2d& opposite,
             Colour colour) {
  cv::rectangle(image, fixed(corner), fixed(opposite), bgr(colour), cv::FILLED, cv::LINE_AA,
                kShift);
}

void drawFrame(cv::Mat& image, const cv::Rect& box, Colour colour) {
  cv::rectangle(image, box, bgr(colour), kOver, cv::LINE_AA);
}

void write(cv::Mat& image, const std::string& words, const cv::Point2d& at, double align,
           double size, Colour colour) {
  int baseline = 0;
  const auto box = sizeOf(words, size, &baseline);
  const cv::Point origin(static_cast<int>(at.x - align * box.width),
                         static_cast<int>(at.y + 0.5 * box.height));
  cv::putText(image, words, origin, kFont, size * kOver, bgr(colour), kOver, cv::LINE_AA);
}

void writeUpwards(cv::Mat& image, const std::string& words, const cv::Point2d& centre, double size,
                  Colour colour) {
  int baseline = 0;
  const auto box = sizeOf(words, size, &baseline);
  cv::Mat strip(box.height + 2 * baseline + 4, box.width + 4, CV_8UC3, cv::Scalar::all(255));
  write(strip, words, {0.5 * strip.cols, 0.5 * strip.rows}, 0.5, size, colour);
  cv::rotate(strip, strip, cv::ROTATE_90_COUNTERCLOCKWISE);
  const cv::Rect wanted(static_cast<int>(centre.x) - strip.cols / 2,
                        static_cast<int>(centre.y) - strip.rows / 2, strip.cols, strip.rows);
  const cv::Rect inside = wanted & cv::Rect({0, 0}, image.size());
  strip(inside - wanted.tl()).copyTo(image(inside));
}

int widthOf(const std::string& words, double size) {
  int baseline = 0;
  return sizeOf(words, size, &baseline).width;
}

}  // namespace headway::eval
