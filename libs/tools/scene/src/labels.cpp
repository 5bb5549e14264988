// SPDX-License-Identifier: BSD-3-Clause
#include "labels.h"

#include <headway/core/object_class.h>
#include <headway/core/text.h>
#include <headway/map/track_geometry.h>
#include <headway/plot/colours.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "overlay.h"

namespace headway::scene {
namespace {

constexpr double kLabelPoints = 9.5;
constexpr double kMaxLabelDistanceM = 70.0;
constexpr int kRows = 6;  ///< of alternative places above a box

std::string labelOf(const Track& track) {
  std::string label(displayName(track.object_class));
  label += " " + std::to_string(track.id.value);
  if (isMoving(track)) label += formatted("  %.1f m/s", track.velocity.norm());
  return label;
}

/// The box's outline in the picture; empty if a corner is behind the camera or far outside.
std::vector<cv::Point> outlineOf(const Track& track, const render::PinholeView& view) {
  std::vector<cv::Point> corners, outline;
  for (const auto& corner : map::boxCorners(track)) {
    const auto pixel = render::project(corner, view);
    if (!pixel || pixel->cwiseAbs().maxCoeff() > 1e5) return {};
    corners.emplace_back(cvRound(pixel->x()), cvRound(pixel->y()));
  }
  cv::convexHull(corners, outline);
  return outline;
}

struct ShownTrack {
  const Track* track;
  std::vector<cv::Point> outline;  ///< see outlineOf() [px]
};

/// The shown tracks in ascending distance from the viewpoint.
std::vector<ShownTrack> nearestFirst(const std::vector<Track>& tracks,
                                     const render::PinholeView& view) {
  const Eigen::Vector3d viewpoint = view.T_map_camera.translation();
  auto shown = shownTracks(tracks);
  std::stable_sort(shown.begin(), shown.end(), [&](const Track* a, const Track* b) {
    return (a->position - viewpoint).norm() < (b->position - viewpoint).norm();
  });
  std::vector<ShownTrack> result;
  for (const Track* track : shown) result.push_back({track, outlineOf(*track, view)});
  return result;
}

struct PlacedLabel {
  std::string text;
  Colour colour;
  cv::Rect rect;  ///< [px]
  cv::Point top;  ///< middle of the box's upper edge [px]
};

/// A line from the label's nearest edge to its box.
void drawLeader(Canvas& canvas, const PlacedLabel& label) {
  const cv::Point& top = label.top;
  const int x = std::clamp(top.x, label.rect.x, label.rect.br().x);
  const int y = std::clamp(top.y, label.rect.y, label.rect.br().y);
  canvas.line({double(x), double(y)}, {double(top.x), double(top.y)}, 1.0, label.colour);
}

}  // namespace

void LabelLayout::occupy(const cv::Rect& rect) {
  const cv::Rect inside = rect & cv::Rect({0, 0}, occupied_.size());
  if (!inside.empty()) occupied_(inside).setTo(1);
}

void LabelLayout::occupy(const std::vector<cv::Point>& outline) {
  if (!outline.empty()) cv::fillConvexPoly(occupied_, outline, cv::Scalar(1));
}

bool LabelLayout::isFree(const cv::Rect& rect) const {
  const cv::Rect inside = rect & cv::Rect({0, 0}, occupied_.size());
  return inside == rect && cv::countNonZero(occupied_(rect)) == 0;
}

std::optional<cv::Rect> LabelLayout::place(const cv::Size& label, const cv::Rect& box, int gap) {
  const int middle = box.x + box.width / 2 - label.width / 2;
  const int above = box.y - label.height - gap;
  const int step = label.height + std::max(2, gap / 2);
  std::vector<cv::Point> corners;
  for (int row = 0; row < kRows; ++row) {
    for (const int aside : {0, -label.width / 2, label.width / 2}) {
      corners.emplace_back(middle + aside, above - row * step);
    }
  }
  const int beside = box.y + box.height / 2 - label.height / 2;
  corners.emplace_back(box.br().x + gap, beside);
  corners.emplace_back(box.x - gap - label.width, beside);
  corners.emplace_back(middle, box.br().y + gap);
  for (const auto& corner : corners) {
    const cv::Rect rect(corner, label);
    if (!isFree(rect)) continue;
    occupy(rect);
    return rect;
  }
  return std::nullopt;
}

std::vector<cv::Rect> drawLabels(Canvas& canvas, const render::PinholeView& view,
                                 const std::vector<Track>& tracks, double scale,
                                 const std::vector<cv::Rect>& panels) {
  const Eigen::Vector3d viewpoint = view.T_map_camera.translation();
  LabelLayout layout(canvas.size());
  for (const auto& panel : panels) layout.occupy(panel);
  const auto nearest = nearestFirst(tracks, view);
  for (const auto& shown : nearest) layout.occupy(shown.outline);
  const int pad = canvas.px(4);
  std::vector<PlacedLabel> labels;
  for (const auto& [track, outline] : nearest) {
    const double max_distance =
        kMaxLabelDistanceM * scale + std::abs(viewpoint.z() - track->position.z());
    if (outline.empty() || (track->position - viewpoint).norm() > max_distance) continue;
    const cv::Rect box = cv::boundingRect(outline);
    const cv::Point top(box.x + box.width / 2, box.y);
    if (!cv::Rect({0, 0}, canvas.size()).contains(top)) continue;
    const std::string text = labelOf(*track);
    const cv::Size size = canvas.textSize(text, kLabelPoints);
    const auto rect = layout.place({size.width + 2 * pad, size.height + 2 * pad}, box, pad);
    if (!rect) continue;
    labels.push_back({text, labelColour(track->object_class, canvas.palette()), *rect, top});
  }
  std::vector<cv::Rect> places;
  for (const auto& label : labels) {  // first, below all text
    const bool apart = label.rect.br().y < label.top.y - 2 * pad || label.rect.y > label.top.y;
    if (apart) drawLeader(canvas, label);
    places.push_back(label.rect);
  }
  for (const auto& label : labels) {
    canvas.panel(label.rect, 0.85);
    canvas.text(label.text, {label.rect.x + pad, label.rect.br().y - pad}, kLabelPoints,
                label.colour, false);
  }
  return places;
}

}  // namespace headway::scene
