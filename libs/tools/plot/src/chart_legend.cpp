// SPDX-License-Identifier: BSD-3-Clause
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "drawing.h"

namespace headway::plot {
namespace {

constexpr double kTextScale = 0.5;
constexpr int kRow = 22 * kOversampling;
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
  const cv::Size size(max_width + kSampleLength + 3 * kMargin,
                      kRow * static_cast<int>(entries_.size()) + kMargin);
  const cv::Rect box = frame_.legend_beside
                           ? cv::Rect({axes_.x + axes_.width + kMargin, axes_.y}, size)
                           : emptiestCorner(image, axes_, size);
  cv::rectangle(image, box, cv::Scalar::all(255), cv::FILLED);
  drawFrame(image, box, kGrid);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const double y = box.y + 0.5 * kMargin + kRow * (static_cast<double>(i) + 0.5);
    const cv::Point2d from(box.x + kMargin, y);
    const cv::Point2d to(from.x + kSampleLength, y);
    Stroke(entries_[i].colour, 3.0, entries_[i].style).draw(image, from, to);
    drawText(image, entries_[i].name, {to.x + kMargin, y}, 0.0, kTextScale, kInk);
  }
}

}  // namespace headway::plot
