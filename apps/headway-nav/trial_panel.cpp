// SPDX-License-Identifier: BSD-3-Clause
#include "trial_panel.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr int kShift = 4;          // bits of a pixel's fraction
constexpr double kSpacingPx = 20;  // of the grid's lines, at least

}  // namespace

TrialPanel::TrialPanel(cv::Mat image, const RobotParams& robot, const Eigen::AlignedBox2d& bounds)
    : image_(std::move(image)),
      robot_(robot),
      middle_(bounds.center()),
      pixels_per_m_(std::min((kPictureHeight - kTitleHeight - kLegendHeight) / bounds.sizes().x(),
                             image_.cols / bounds.sizes().y())) {}

void TrialPanel::drawGround() {
  const Vector2d reach(0.5 * (kPictureHeight - kTitleHeight - kLegendHeight) / pixels_per_m_,
                       0.5 * image_.cols / pixels_per_m_);
  const Vector2d least = middle_ - reach, greatest = middle_ + reach;
  const double spacing = spacingM();
  const auto firstFrom = [&](double from) { return spacing * std::ceil(from / spacing); };
  for (double x = firstFrom(least.x()); x <= greatest.x(); x += spacing) {
    line({x, least.y()}, {x, greatest.y()}, kFaint, 1);
  }
  for (double y = firstFrom(least.y()); y <= greatest.y(); y += spacing) {
    line({least.x(), y}, {greatest.x(), y}, kFaint, 1);
  }
  cv::line(image_, {image_.cols - 1, 0}, {image_.cols - 1, image_.rows}, kFaint, 1);
  drawScale(spacing);
  circle({robot_.goal_m, 0.0}, 0.4, kRobot, 2);
  text("goal", {robot_.goal_m, -0.6}, 0.45, kRobot);
}

void TrialPanel::circle(const Vector2d& centre, double radius_m, const cv::Scalar& colour,
                        int thickness) {
  const int radius = static_cast<int>(radius_m * pixels_per_m_ * (1 << kShift));
  cv::circle(image_, at(centre), radius, colour, thickness, cv::LINE_AA, kShift);
}

void TrialPanel::dot(const Vector2d& centre, int radius_px, const cv::Scalar& colour) {
  cv::circle(image_, at(centre), radius_px << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
}

void TrialPanel::line(const Vector2d& from, const Vector2d& to, const cv::Scalar& colour,
                      int thickness) {
  cv::line(image_, at(from), at(to), colour, thickness, cv::LINE_AA, kShift);
}

void TrialPanel::robot(const mrpt::math::TPose2D& pose, const cv::Scalar& colour, int thickness) {
  std::vector<cv::Point> corners;
  const double x = 0.5 * robot_.length_m;
  const double y = 0.5 * robot_.width_m;
  for (const Vector2d& corner :
       {Vector2d(x, y), Vector2d(x, -y), Vector2d(-x, -y), Vector2d(-x, y)}) {
    const Vector2d turned = Eigen::Rotation2Dd(pose.phi) * corner;
    corners.push_back(at(Vector2d(pose.x, pose.y) + turned));
  }
  if (thickness == cv::FILLED) {
    cv::fillConvexPoly(image_, corners, colour, cv::LINE_AA, kShift);
  } else {
    cv::polylines(image_, corners, true, colour, thickness, cv::LINE_AA, kShift);
  }
}

void TrialPanel::text(const std::string& words, const Vector2d& place, double size,
                      const cv::Scalar& colour) {
  const cv::Point corner = at(place);
  const cv::Point left(corner.x >> kShift, corner.y >> kShift);
  int baseline = 0;
  const cv::Size extent =
      cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, size, 1, &baseline) + cv::Size(4, 4);
  const cv::Rect covered({left.x - 2, left.y - extent.height + 2}, extent);
  for (const auto& other : texts_) {
    if (!(covered & other).empty()) return;
  }
  texts_.push_back(covered);
  cv::putText(image_, words, left, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

void TrialPanel::title(const std::string& name, const std::string& state, bool bad) {
  cv::rectangle(image_, {0, 0, image_.cols, kTitleHeight}, kPaper, cv::FILLED);
  cv::putText(image_, name, {14, 27}, cv::FONT_HERSHEY_SIMPLEX, 0.75, kInk, 2, cv::LINE_AA);
  cv::putText(image_, state, {14, 52}, cv::FONT_HERSHEY_SIMPLEX, 0.5, bad ? kContact : kInk, 1,
              cv::LINE_AA);
  cv::line(image_, {0, kTitleHeight}, {image_.cols, kTitleHeight}, kFaint, 1);
}

bool TrialPanel::shows(const Vector2d& place) const {
  const cv::Point p = at(place);
  return p.y >> kShift > kTitleHeight && p.y >> kShift < kPictureHeight - kLegendHeight &&
         p.x > 0 && p.x >> kShift < image_.cols;
}

/// Distance of the grid's lines [m].
double TrialPanel::spacingM() const {
  double spacing = 2.0;
  while (spacing * pixels_per_m_ < kSpacingPx) spacing *= 5.0;
  return spacing;
}

/// A bar as long as the grid's spacing, at the lower left.
void TrialPanel::drawScale(double metres) {
  const int y = kPictureHeight - kLegendHeight - 14, x = 14;
  const int end = x + cvRound(metres * pixels_per_m_);
  const std::string words = cv::format("%.0f m", metres);
  cv::line(image_, {x, y}, {end, y}, kInk, 2);
  cv::putText(image_, words, {end + 8, y + 5}, cv::FONT_HERSHEY_SIMPLEX, 0.48, kInk, 1,
              cv::LINE_AA);
  texts_.emplace_back(x, y - 10, end + 50 - x, 20);
}

/// Pixel of a position, with kShift bits of fraction: x upwards, y to the left.
cv::Point TrialPanel::at(const Vector2d& place) const {
  const Vector2d offset = pixels_per_m_ * (place - middle_);
  const double u = 0.5 * image_.cols - offset.y();
  const double v = 0.5 * (kTitleHeight + kPictureHeight - kLegendHeight) - offset.x();
  return {cvRound(u * (1 << kShift)), cvRound(v * (1 << kShift))};
}

}  // namespace headway::app
