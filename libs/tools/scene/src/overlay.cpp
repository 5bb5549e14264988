// SPDX-License-Identifier: BSD-3-Clause
// What is written and outlined over a picture: boxes, labels, legend, caption.
#include "overlay.h"

#include <headway/core/object_class.h>
#include <headway/core/text.h>
#include <headway/map/track_geometry.h>
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "view.h"

namespace headway::scene {
namespace {

constexpr double kMargin = 18.0;      ///< to the edge of the picture [points]
constexpr double kTextPoints = 11.0;  ///< height of capitals [points]
constexpr double kLabelPoints = 9.5;

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
  for (int row = 0; row < 6; ++row) {
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
    const double max_distance = 70.0 * scale + std::abs(viewpoint.z() - track->position.z());
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

namespace {

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
              kTextPoints, canvas.palette().text, false);
}

cv::Rect Legend::draw(Canvas& canvas, const SnapshotInput& input, Layout layout) {
  const auto shown = entries(input, layout, canvas.palette());
  if (shown.empty()) return {};
  std::vector<int> widths;
  int total = 0;
  for (const auto& entry : shown) {
    widths.push_back(canvas.px(kSwatch + 2.0 * kGap) +
                     canvas.textSize(entry.text, kTextPoints).width);
    total += widths.back() + canvas.px(kGap);
  }
  const bool row = layout == Layout::kRow;
  const int margin = canvas.px(kMargin);
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

namespace {

/// Narrower at close range, where a band would hide what it passes.
double bandWidth(const Track& track, double scale) {
  return std::sqrt(scale) * (isVehicle(track.object_class) ? 0.30 : 0.16);
}

/// Fills a horizontal band along a polyline; segments behind the camera are omitted.
void drawBand(Canvas& canvas, const render::PinholeView& view,
              const std::vector<Eigen::Vector3d>& polyline, const map::HalfWidths& half_widths,
              Colour colour) {
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    const Eigen::Vector3d step = polyline[i] - polyline[i - 1];
    const double length = step.head<2>().norm();
    if (length < 1e-9) continue;
    const Eigen::Vector3d normal(-step.y() / length, step.x() / length, 0.0);
    std::vector<Eigen::Vector2d> corners;
    for (const Eigen::Vector3d& corner :
         {Eigen::Vector3d(polyline[i - 1] + half_widths[i - 1] * normal),
          Eigen::Vector3d(polyline[i - 1] - half_widths[i - 1] * normal),
          Eigen::Vector3d(polyline[i] - half_widths[i] * normal),
          Eigen::Vector3d(polyline[i] + half_widths[i] * normal)}) {
      if (const auto pixel = render::project(corner, view)) corners.push_back(*pixel);
    }
    if (corners.size() == 4) canvas.polygon(corners, colour);
  }
}

void drawBand(Canvas& canvas, const render::PinholeView& view,
              const std::vector<Eigen::Vector3d>& polyline, double width, Colour colour) {
  drawBand(canvas, view, polyline, map::HalfWidths(polyline.size(), 0.5 * width), colour);
}

map::HalfWidths oneSigma(const Track& track, const PredictedPath& prediction, double scale) {
  map::HalfWidths half_widths{0.5 * bandWidth(track, scale)};
  for (const auto& point : prediction.points) {
    half_widths.push_back(std::sqrt(std::max(0.0, 0.5 * point.covariance.trace())));
  }
  return half_widths;
}

void drawFrontFace(Canvas& canvas, const render::PinholeView& view, const Track& track) {
  const auto corners = map::boxCorners(track);
  std::vector<Eigen::Vector2d> face;
  for (const std::size_t i : {0u, 1u, 5u, 4u}) {
    if (const auto pixel = render::project(corners[i], view)) face.push_back(*pixel);
  }
  if (face.size() == 4) canvas.polygon(face, colourOf(track.object_class));
}

/// Draws with `draw` on a copy of the picture and blends it with the picture.
template <typename Draw>
void blended(Canvas& canvas, double opacity, const Draw& draw) {
  cv::Mat layer = canvas.picture().clone();
  Canvas copy(layer, canvas);
  draw(copy);
  cv::addWeighted(layer, opacity, canvas.picture(), 1.0 - opacity, 0.0, canvas.picture());
}

template <typename Draw>
void forEachPath(const std::vector<const Track*>& tracks, const Draw& draw) {
  for (const Track* track : tracks) {
    if (!isMoving(*track)) continue;
    for (const auto& prediction : track->predictions) {
      const auto path = map::groundPath(*track, prediction);
      if (map::lengthOf(path) >= 0.5) draw(*track, prediction, path);
    }
  }
}

void drawSegment(Canvas& canvas, const render::PinholeView& view, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to, double points, Colour colour) {
  const auto segment = render::projectSegment(from, to, view);
  if (segment) canvas.line(segment->first, segment->second, points, colour);
}

void drawEdges(Canvas& canvas, const render::PinholeView& view, const Track& track, double points,
               Colour colour, const Hides& hides = {}) {
  const auto corners = map::boxCorners(track);
  const int parts = hides ? 8 : 1;  // that are hidden or not
  for (const auto& [a, b] : map::kBoxEdges) {
    const Eigen::Vector3d& from = corners[static_cast<std::size_t>(a)];
    const Eigen::Vector3d step = (corners[static_cast<std::size_t>(b)] - from) / parts;
    const auto isHidden = [&](int part) { return hides && hides(from + (part + 0.5) * step); };
    bool hidden = isHidden(0);
    for (int i = 0, end = 1; i < parts; i = end++) {  // as long as all is hidden or nothing
      bool next = hidden;
      while (end < parts && (next = isHidden(end)) == hidden) ++end;
      drawSegment(canvas, view, from + i * step, from + end * step, hidden ? 0.6 : points, colour);
      hidden = next;
    }
  }
}

}  // namespace

std::vector<const Track*> shownTracks(const std::vector<Track>& tracks) {
  std::vector<const Track*> shown;
  for (const auto& track : tracks) {
    if (isShown(track)) shown.push_back(&track);
  }
  return shown;
}

void drawTracksOver(Canvas& canvas, const render::PinholeView& view,
                    const std::vector<Track>& tracks, double scale) {
  const auto shown = shownTracks(tracks);
  blended(canvas, 0.30, [&](Canvas& layer) {
    forEachPath(shown, [&](const Track& track, const PredictedPath& prediction, const auto& path) {
      drawBand(layer, view, path, oneSigma(track, prediction, scale), layer.palette().prediction);
    });
    for (const Track* track : shown) drawFrontFace(layer, view, *track);
  });
  blended(canvas, 0.88, [&](Canvas& layer) {
    for (const Track* track : shown) {
      if (isMoving(*track)) {
        drawBand(layer, view, map::groundTrail(*track), 0.4 * bandWidth(*track, scale),
                 colourOf(track->object_class));
      }
    }
    forEachPath(shown, [&](const Track& track, const PredictedPath&, const auto& path) {
      for (const auto& dash : map::dashesOf(path, scale * 0.8, scale * 0.5)) {
        drawBand(layer, view, dash, 1.2 * bandWidth(track, scale), layer.palette().prediction);
      }
    });
  });
  drawBoxes(canvas, view, tracks);
}

void drawLandmarksOver(Canvas& canvas, const render::PinholeView& view,
                       const slam::MapView& static_map) {
  const int radius = canvas.px(1.0);
  for (const auto& landmark : static_map.landmarks) {
    const auto pixel = render::project(landmark.position, view);
    if (!pixel || pixel->cwiseAbs().maxCoeff() > 1e5) continue;
    const double grey = 70.0 + 0.7 * landmark.intensity;
    cv::circle(canvas.picture(), cv::Point(cvRound(pixel->x()), cvRound(pixel->y())), radius,
               cv::Scalar(grey, grey, grey), cv::FILLED, cv::LINE_AA);
  }
}

void drawBoxes(Canvas& canvas, const render::PinholeView& view, const std::vector<Track>& tracks,
               const Hides& hides) {
  for (const Track* track : shownTracks(tracks)) {
    drawEdges(canvas, view, *track, track->status == TrackStatus::kConfirmed ? 1.8 : 1.0,
              colourOf(track->object_class), hides);
  }
}

void drawTrueBoxes(Canvas& canvas, const render::PinholeView& view,
                   const std::vector<Track>& objects) {
  for (const auto& object : objects) drawEdges(canvas, view, object, 1.0, canvas.palette().truth);
}

void drawFrustum(Canvas& canvas, const render::PinholeView& view, const StereoCamera& camera,
                 const Pose& T_map_robot, double scale) {
  for (const auto& [from, to] : frustumEdges(camera, T_map_robot, scale)) {
    drawSegment(canvas, view, from, to, 1.6, canvas.palette().path);
  }
}

namespace {

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
  const std::string first = formatted("%.2f s", input.time - start) + "   " +
                            formatted("%.1f m/s over 1 s", speedOf(input.path));
  const std::string second =
      "frame " + std::to_string(input.frame) + "   " + std::to_string(shown.size()) +
      (shown.size() == 1 ? " track, " : " tracks, ") + std::to_string(moving) + " moving";
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
  const int width = cvRound(0.30 * canvas.size().width);
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
