// SPDX-License-Identifier: BSD-3-Clause
#include "overlay.h"

#include <headway/core/text.h>
#include <headway/map/track_geometry.h>
#include <headway/plot/colours.h>
#include <headway/plot/ticks.h>

#include <algorithm>
#include <cmath>

#include "view.h"

namespace headway::scene {
namespace {

constexpr int kMargin = 18;           ///< to the edge of the picture [points]
constexpr double kTextPoints = 11.0;  ///< height of capitals [points]
constexpr double kInsetWidth = 0.30;  ///< ratio of the picture's width

/// Mean speed over the last second of the path [m/s]; 0 without a path.
double speedOf(const std::vector<Stamped<Pose>>& path) {
  if (path.size() < 2) return 0.0;
  std::size_t first = path.size() - 1;
  while (first > 0 && path.back().time - path[first].time < 1.0) --first;
  const double span = path.back().time - path[first].time;
  if (!(span > 0.0)) return 0.0;
  return (path.back().value.translation() - path[first].value.translation()).norm() / span;
}

}  // namespace

cv::Rect drawCaption(Canvas& canvas, const SnapshotInput& input) {
  const auto shown = shownTracks(input.map.movingObjects().tracks());
  const auto moving = std::count_if(shown.begin(), shown.end(),
                                    [](const Track* track) { return isMoving(*track); });
  const double start = input.path.empty() ? input.time : input.path.front().time;
  const std::string first =
      formatted("%.2f s", input.time - start) + "   " + formatted("%.1f m/s", speedOf(input.path));
  const std::string second = "frame " + std::to_string(input.frame) + "   " +
                             std::to_string(shown.size()) + " tracks, " + std::to_string(moving) +
                             " moving";
  const int margin = canvas.px(kMargin);
  const int width =
      std::max(canvas.textSize(first, 15.0).width, canvas.textSize(second, kTextPoints).width);
  const cv::Rect panel(margin - canvas.px(8), margin - canvas.px(8), width + canvas.px(16),
                       canvas.px(56));
  canvas.panel(panel);
  canvas.text(first, {margin, margin + canvas.px(15)}, 15.0, canvas.palette().text, false);
  canvas.text(second, {margin, margin + canvas.px(38)}, kTextPoints, canvas.palette().dim_text,
              false);
  return panel;
}

cv::Rect drawScaleBar(Canvas& canvas, double metres_per_pixel) {
  const double length = plot::scaleBarLength(metres_per_pixel * canvas.size().width / 5.0);
  const int width = cvRound(length / metres_per_pixel);
  const int margin = canvas.px(kMargin);
  const cv::Point right(canvas.size().width - margin, canvas.size().height - margin);
  const std::string text = formatted("%g m", length);
  const cv::Rect panel(right.x - width - canvas.px(8), right.y - canvas.px(34),
                       width + canvas.px(16), canvas.px(44));
  canvas.panel(panel);
  canvas.filled({right.x - width, right.y - canvas.px(4), width, canvas.px(4)},
                canvas.palette().text);
  canvas.text(text, {right.x - width, right.y - canvas.px(11)}, kTextPoints, canvas.palette().text,
              false);
  return panel;
}

cv::Rect drawGridNote(Canvas& canvas, double spacing_m) {
  const std::string text = formatted("grid %g m", spacing_m);
  const cv::Size size = canvas.textSize(text, kTextPoints);
  const int margin = canvas.px(kMargin);
  const cv::Point at(canvas.size().width - margin - size.width, canvas.size().height - margin);
  const cv::Rect panel(at.x - canvas.px(8), at.y - size.height - canvas.px(8),
                       size.width + canvas.px(16), size.height + canvas.px(16));
  canvas.panel(panel);
  canvas.text(text, at, kTextPoints, canvas.palette().dim_text);
  return panel;
}

cv::Rect drawInset(Canvas& canvas, const SnapshotInput& input) {
  if (input.image.empty() || input.camera == nullptr) return {};
  const int width = cvRound(kInsetWidth * canvas.size().width);
  const int height = std::max(1, width * input.image.rows / std::max(1, input.image.cols));
  const int margin = canvas.px(kMargin);
  const cv::Rect rect(canvas.size().width - width - margin, margin, width, height);
  if (rect.x < 0 || rect.br().y > canvas.size().height) return {};
  canvas.image(input.image, rect);
  cv::Mat part = canvas.picture()(rect);
  Canvas inset(part, canvas, 0.55);
  drawTracksOver(inset, cameraView(*input.camera, input.T_map_robot, rect.size()),
                 input.map.movingObjects().tracks(), sceneScale(input));
  canvas.outline(rect, canvas.palette().dim_text);
  return rect;
}

}  // namespace headway::scene
