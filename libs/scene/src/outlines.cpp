#include "outlines.h"

#include <headway/map/track_geometry.h>

#include "frustum.h"
#include "palette.h"
#include "shown_tracks.h"

namespace headway::scene {
namespace {

void drawSegment(Canvas& canvas, const render::PinholeView& view, const Eigen::Vector3d& from,
                 const Eigen::Vector3d& to, double points, Colour colour) {
  const auto segment = render::projectSegment(from, to, view);
  if (segment) canvas.line(segment->first, segment->second, points, colour);
}

void drawEdges(Canvas& canvas, const render::PinholeView& view, const Track& track, double points,
               Colour colour) {
  const auto corners = map::boxCorners(track);
  for (const auto& [a, b] : map::kBoxEdges) {
    drawSegment(canvas, view, corners[static_cast<std::size_t>(a)],
                corners[static_cast<std::size_t>(b)], points, colour);
  }
}

}  // namespace

void drawBoxes(Canvas& canvas, const render::PinholeView& view, const std::vector<Track>& tracks) {
  for (const Track* track : shownTracks(tracks)) {
    drawEdges(canvas, view, *track, track->status == TrackStatus::kConfirmed ? 1.8 : 1.0,
              colourOf(track->object_class));
  }
}

void drawTrueBoxes(Canvas& canvas, const render::PinholeView& view,
                   const std::vector<Track>& objects) {
  for (const auto& object : objects) drawEdges(canvas, view, object, 1.0, kTruthColour);
}

void drawFrustum(Canvas& canvas, const render::PinholeView& view, const StereoCamera& camera,
                 const Pose& T_map_robot) {
  for (const auto& [from, to] : frustumEdges(camera, T_map_robot)) {
    drawSegment(canvas, view, from, to, 1.6, kPathColour);
  }
}

}  // namespace headway::scene
