// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/track_geometry.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "overlay.h"
#include "view.h"

namespace headway::scene {
namespace {

constexpr double kFillOpacity = 0.30;
constexpr double kPathOpacity = 0.88;
constexpr double kDashLengthM = 0.8;
constexpr double kDashGapM = 0.5;
constexpr double kMinPathLengthM = 0.5;
constexpr double kHiddenEdge = 0.6;  ///< of a box, behind the map [points]
constexpr int kEdgeParts = 8;        ///< that are hidden or not

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
      if (map::lengthOf(path) >= kMinPathLengthM) draw(*track, prediction, path);
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
  const int parts = hides ? kEdgeParts : 1;
  for (const auto& [a, b] : map::kBoxEdges) {
    const Eigen::Vector3d& from = corners[static_cast<std::size_t>(a)];
    const Eigen::Vector3d step = (corners[static_cast<std::size_t>(b)] - from) / parts;
    const auto isHidden = [&](int part) { return hides && hides(from + (part + 0.5) * step); };
    bool hidden = isHidden(0);
    for (int i = 0, end = 1; i < parts; i = end++) {  // as long as all is hidden or nothing
      bool next = hidden;
      while (end < parts && (next = isHidden(end)) == hidden) ++end;
      drawSegment(canvas, view, from + i * step, from + end * step, hidden ? kHiddenEdge : points,
                  colour);
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
  blended(canvas, kFillOpacity, [&](Canvas& layer) {
    forEachPath(shown, [&](const Track& track, const PredictedPath& prediction, const auto& path) {
      drawBand(layer, view, path, oneSigma(track, prediction, scale), layer.palette().prediction);
    });
    for (const Track* track : shown) drawFrontFace(layer, view, *track);
  });
  blended(canvas, kPathOpacity, [&](Canvas& layer) {
    for (const Track* track : shown) {
      if (isMoving(*track)) {
        drawBand(layer, view, map::groundTrail(*track), 0.4 * bandWidth(*track, scale),
                 colourOf(track->object_class));
      }
    }
    forEachPath(shown, [&](const Track& track, const PredictedPath&, const auto& path) {
      for (const auto& dash : map::dashesOf(path, scale * kDashLengthM, scale * kDashGapM)) {
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

}  // namespace headway::scene
