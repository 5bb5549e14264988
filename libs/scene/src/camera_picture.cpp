#include "camera_picture.h"

#include <headway/map/ribbon.h>
#include <headway/map/track_geometry.h>

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "outlines.h"
#include "shown_tracks.h"

namespace headway::scene {
namespace {

constexpr double kSeeThrough = 0.30;
constexpr double kNearlySolid = 0.88;
constexpr double kDashM = 0.8;
constexpr double kGapM = 0.5;
constexpr double kShortestPathM = 0.5;

double bandWidth(const Track& track) { return isVehicle(track.object_class) ? 0.30 : 0.16; }

/// Fills a level band along a polyline, piece by piece; pieces behind the camera are left out.
void drawBand(Canvas& canvas, const render::PinholeView& view,
              const std::vector<Eigen::Vector3d>& polyline, const map::HalfWidths& half_widths,
              Colour colour) {
  for (std::size_t i = 1; i < polyline.size(); ++i) {
    const Eigen::Vector3d way = polyline[i] - polyline[i - 1];
    const double length = way.head<2>().norm();
    if (length < 1e-9) continue;
    const Eigen::Vector3d normal(-way.y() / length, way.x() / length, 0.0);
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

map::HalfWidths oneSigma(const Track& track, const PredictedPath& prediction) {
  map::HalfWidths half_widths{0.5 * bandWidth(track)};
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

/// Lets `draw` work on a copy and lays that over the picture, see-through.
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
      if (map::lengthOf(path) >= kShortestPathM) draw(*track, prediction, path);
    }
  }
}

}  // namespace

void drawTracksOver(Canvas& canvas, const render::PinholeView& view,
                    const std::vector<Track>& tracks) {
  const auto shown = shownTracks(tracks);
  blended(canvas, kSeeThrough, [&](Canvas& layer) {
    forEachPath(shown, [&](const Track& track, const PredictedPath& prediction, const auto& path) {
      drawBand(layer, view, path, oneSigma(track, prediction), kPredictionColour);
    });
    for (const Track* track : shown) drawFrontFace(layer, view, *track);
  });
  blended(canvas, kNearlySolid, [&](Canvas& layer) {
    for (const Track* track : shown) {
      if (isMoving(*track)) {
        drawBand(layer, view, map::groundTrail(*track), 0.4 * bandWidth(*track),
                 colourOf(track->object_class));
      }
    }
    forEachPath(shown, [&](const Track& track, const PredictedPath&, const auto& path) {
      for (const auto& dash : map::dashesOf(path, kDashM, kGapM)) {
        drawBand(layer, view, dash, 1.2 * bandWidth(track), kPredictionColour);
      }
    });
  });
  drawBoxes(canvas, view, tracks);
}

void drawLandmarksOver(Canvas& canvas, const render::PinholeView& view,
                       const slam::MapView& still_world) {
  const int radius = canvas.px(1.0);
  for (const auto& landmark : still_world.landmarks) {
    const auto pixel = render::project(landmark.position, view);
    if (!pixel || pixel->cwiseAbs().maxCoeff() > 1e5) continue;
    const double grey = 70.0 + 0.7 * landmark.intensity;
    cv::circle(canvas.picture(), cv::Point(cvRound(pixel->x()), cvRound(pixel->y())), radius,
               cv::Scalar(grey, grey, grey), cv::FILLED, cv::LINE_AA);
  }
}

}  // namespace headway::scene
