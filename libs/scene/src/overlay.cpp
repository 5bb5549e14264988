// SPDX-License-Identifier: BSD-3-Clause
#include "overlay.h"

#include <headway/core/formatted.h>
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
constexpr double kLabelPoints = 9.5;
constexpr double kMaxLabelDistanceM = 70.0;
constexpr int kLabelRows = 3;         ///< alternative label positions above a box
constexpr double kInsetWidth = 0.30;  ///< ratio of the picture's width

std::string labelOf(const Track& track) {
  std::string label(toString(track.object_class));
  label += " " + std::to_string(track.id.value);
  if (isMoving(track)) label += formatted("  %.1f m/s", track.velocity.norm());
  return label;
}

/// Centre of the upper edge of a box's bounding rectangle in the picture; nullopt if a corner is
/// behind the camera.
std::optional<cv::Point> topOf(const Track& track, const render::PinholeView& view) {
  double left = 1e9, right = -1e9, top = 1e9;
  for (const auto& corner : map::boxCorners(track)) {
    const auto pixel = render::project(corner, view);
    if (!pixel) return std::nullopt;
    left = std::min(left, pixel->x());
    right = std::max(right, pixel->x());
    top = std::min(top, pixel->y());
  }
  return cv::Point(cvRound(0.5 * (left + right)), cvRound(top));
}

/// The given rectangle or one of those above it that overlaps none of `occupied`; nullopt if there
/// is none.
std::optional<cv::Rect> freeRect(cv::Rect rect, const std::vector<cv::Rect>& occupied) {
  for (int row = 0; row < kLabelRows; ++row, rect.y -= rect.height + 2) {
    const bool overlaps = std::any_of(occupied.begin(), occupied.end(), [&](const cv::Rect& other) {
      return !(other & rect).empty();
    });
    if (!overlaps) return rect;
  }
  return std::nullopt;
}

/// The shown tracks in ascending distance from the viewpoint.
std::vector<const Track*> nearestFirst(const std::vector<Track>& tracks,
                                       const Eigen::Vector3d& viewpoint) {
  auto shown = shownTracks(tracks);
  std::stable_sort(shown.begin(), shown.end(), [&](const Track* a, const Track* b) {
    return (a->position - viewpoint).norm() < (b->position - viewpoint).norm();
  });
  return shown;
}

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

void drawLabels(Canvas& canvas, const render::PinholeView& view, const std::vector<Track>& tracks,
                double scale) {
  const Eigen::Vector3d viewpoint = view.T_map_camera.translation();
  std::vector<cv::Rect> occupied;
  for (const Track* track : nearestFirst(tracks, viewpoint)) {
    const auto top = topOf(*track, view);
    const double max_distance =
        kMaxLabelDistanceM * scale + std::abs(viewpoint.z() - track->position.z());
    if (!top || (track->position - viewpoint).norm() > max_distance) continue;
    if (!cv::Rect({0, 0}, canvas.size()).contains(*top)) continue;
    const std::string label = labelOf(*track);
    const cv::Size size = canvas.textSize(label, kLabelPoints);
    const int pad = canvas.px(4);
    const cv::Rect wanted(top->x - size.width / 2 - pad, top->y - size.height - 3 * pad,
                          size.width + 2 * pad, size.height + 2 * pad);
    const auto rect = freeRect(wanted, occupied);
    if (!rect) continue;
    occupied.push_back(*rect);
    canvas.panel(*rect, 0.72);
    canvas.text(label, {rect->x + pad, rect->y + pad + size.height}, kLabelPoints,
                plot::lightened(colourOf(track->object_class)), false);
  }
}

void drawCaption(Canvas& canvas, const SnapshotInput& input) {
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
  canvas.panel(
      {margin - canvas.px(8), margin - canvas.px(8), width + canvas.px(16), canvas.px(56)});
  canvas.text(first, {margin, margin + canvas.px(15)}, 15.0, kTextColour);
  canvas.text(second, {margin, margin + canvas.px(38)}, kTextPoints, kDimTextColour);
}

void drawScaleBar(Canvas& canvas, double metres_per_pixel) {
  const double length = plot::scaleBarLength(metres_per_pixel * canvas.size().width / 5.0);
  const int width = cvRound(length / metres_per_pixel);
  const int margin = canvas.px(kMargin);
  const cv::Point right(canvas.size().width - margin, canvas.size().height - margin);
  const std::string text = formatted("%g m", length);
  canvas.panel({right.x - width - canvas.px(8), right.y - canvas.px(34), width + canvas.px(16),
                canvas.px(44)});
  canvas.filled({right.x - width, right.y - canvas.px(4), width, canvas.px(4)}, kTextColour);
  canvas.text(text, {right.x - width, right.y - canvas.px(11)}, kTextPoints, kTextColour);
}

void drawGridNote(Canvas& canvas, double spacing_m) {
  const std::string text = formatted("grid %g m", spacing_m);
  const cv::Size size = canvas.textSize(text, kTextPoints);
  const int margin = canvas.px(kMargin);
  canvas.text(text, {canvas.size().width - margin - size.width, canvas.size().height - margin},
              kTextPoints, kDimTextColour);
}

void drawInset(Canvas& canvas, const SnapshotInput& input) {
  if (input.image.empty() || input.camera == nullptr) return;
  const int width = cvRound(kInsetWidth * canvas.size().width);
  const int height = std::max(1, width * input.image.rows / std::max(1, input.image.cols));
  const int margin = canvas.px(kMargin);
  const cv::Rect rect(canvas.size().width - width - margin, margin, width, height);
  if (rect.x < 0 || rect.br().y > canvas.size().height) return;
  canvas.image(input.image, rect);
  cv::Mat part = canvas.picture()(rect);
  Canvas inset(part, canvas, 0.55);
  drawTracksOver(inset, cameraView(*input.camera, input.T_map_robot, rect.size()),
                 input.map.movingObjects().tracks(), sceneScale(input));
  canvas.outline(rect, kDimTextColour);
}

}  // namespace headway::scene
