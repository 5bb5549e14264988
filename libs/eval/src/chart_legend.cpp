#include <headway/eval/chart.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "strokes.h"

namespace headway::eval {
namespace {

constexpr double kLetters = 0.5;
constexpr int kRow = 22 * kOver;
constexpr int kSample = 34 * kOver;  // length of the line before a name
constexpr int kMargin = 12 * kOver;

/// Place for a box of that size in the corner of the plot where least is drawn.
cv::Rect emptiestCorner(const cv::Mat& image, const cv::Rect& plot, cv::Size size) {
  const int left = plot.x + kMargin;
  const int right = plot.x + plot.width - size.width - kMargin;
  const int top = plot.y + kMargin;
  const int bottom = plot.y + plot.height - size.height - kMargin;
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

void Chart::legend(const std::string& name, Colour colour, LineStyle style) {
  entries_.push_back({name, colour, style});
}

void Chart::drawLegend(cv::Mat& image) const {
  if (entries_.empty()) return;
  int widest = 0;
  for (const auto& entry : entries_) widest = std::max(widest, widthOf(entry.name, kLetters));
  const cv::Size size(widest + kSample + 3 * kMargin,
                      kRow * static_cast<int>(entries_.size()) + kMargin);
  const cv::Rect box = frame_.legend_beside
                           ? cv::Rect({plot_.x + plot_.width + kMargin, plot_.y}, size)
                           : emptiestCorner(image, plot_, size);
  cv::rectangle(image, box, cv::Scalar::all(255), cv::FILLED);
  drawFrame(image, box, kGrid);
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const double y = box.y + 0.5 * kMargin + kRow * (static_cast<double>(i) + 0.5);
    const cv::Point2d from(box.x + kMargin, y);
    const cv::Point2d to(from.x + kSample, y);
    Stroke(entries_[i].colour, 3.0, entries_[i].style).draw(image, from, to);
    write(image, entries_[i].name, {to.x + kMargin, y}, 0.0, kLetters, kInk);
  }
}

}  // namespace headway::eval
