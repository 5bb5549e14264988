// SPDX-License-Identifier: BSD-3-Clause
#include "legend.h"

#include <headway/core/object_class.h>

#include <algorithm>

#include "overlay.h"

namespace headway::scene {
namespace {

constexpr double kEntryPoints = 11.0;
constexpr double kLegendMargin = 18.0;
constexpr double kRowHeight = 21.0;
constexpr double kSwatch = 22.0;
constexpr double kGap = 10.0;  ///< between swatch and text

}  // namespace

std::vector<Legend::Entry> Legend::entries(const SnapshotInput& input, Layout layout,
                                           const Palette& palette) {
  for (const Track* track : shownTracks(input.map.movingObjects().tracks())) {
    seen_[static_cast<std::size_t>(track->object_class)] = true;
  }
  std::vector<Entry> result;
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const auto object_class = static_cast<ObjectClass>(i);
    if (seen_[i])
      result.push_back({std::string(displayName(object_class)), colourOf(object_class)});
  }
  if (!result.empty()) result.push_back({"prediction, 3 s", palette.prediction, true});
  if (layout == Layout::kColumn) {
    result.push_back({"robot", palette.path});
    if (input.map.staticGrid() != nullptr) {
      result.push_back({"free ground", palette.free});
      result.push_back({"obstacle", palette.occupied});
    }
  }
  if (!input.true_path.empty() || !input.true_objects.empty()) {
    result.push_back({"truth", palette.truth});
  }
  return result;
}

void Legend::drawEntry(Canvas& canvas, const Entry& entry, cv::Point left_middle) {
  const int swatch = canvas.px(kSwatch);
  const int thick = canvas.px(4);
  const int length = entry.dashed ? swatch / 5 : swatch;
  for (int dash = 0; dash < (entry.dashed ? 3 : 1); ++dash) {
    canvas.filled({left_middle.x + 2 * dash * length, left_middle.y - thick / 2, length, thick},
                  entry.colour);
  }
  canvas.text(entry.text, {left_middle.x + swatch + canvas.px(kGap), left_middle.y + canvas.px(5)},
              kEntryPoints, canvas.palette().text, false);
}

cv::Rect Legend::draw(Canvas& canvas, const SnapshotInput& input, Layout layout) {
  const auto shown = entries(input, layout, canvas.palette());
  if (shown.empty()) return {};
  std::vector<int> widths;
  int total = 0;
  for (const auto& entry : shown) {
    widths.push_back(canvas.px(kSwatch + 2.0 * kGap) +
                     canvas.textSize(entry.text, kEntryPoints).width);
    total += widths.back() + canvas.px(kGap);
  }
  const bool row = layout == Layout::kRow;
  const int margin = canvas.px(kLegendMargin);
  const int height = canvas.px(kRowHeight) * (row ? 1 : static_cast<int>(shown.size()));
  const int width = row ? total : *std::max_element(widths.begin(), widths.end());
  cv::Point at(margin, canvas.size().height - margin - height);
  const cv::Rect panel(at.x - canvas.px(8), at.y - canvas.px(6), width + canvas.px(12),
                       height + canvas.px(12));
  canvas.panel(panel);
  at.y += canvas.px(kRowHeight) / 2;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    drawEntry(canvas, shown[i], at);
    if (row) {
      at.x += widths[i] + canvas.px(kGap);
    } else {
      at.y += canvas.px(kRowHeight);
    }
  }
  return panel;
}

}  // namespace headway::scene
