// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/object_class.h>
#include <headway/eval/plots.h>
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>
#include <headway/plot/text_table.h>
namespace headway::eval {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points over(const std::vector<RecallPoint>& curve, double RecallPoint::*figure) {
  Points points;
  for (const auto& point : curve) points.emplace_back(100.0 * point.recall, 100.0 * point.*figure);
  return points;
}

constexpr Colour kTrackTruthColour{170, 205, 235};
constexpr Colour kRawColour{150, 150, 150};
constexpr Colour kTrackCameraColour{110, 110, 110};

Points seenFromAbove(const TrueObject& object) {
  Points points;
  for (const auto& point : object.path) points.emplace_back(point.position.head<2>());
  return points;
}

/// The path, split at gaps of more than a few frames.
std::vector<Points> segments(const TrueObject& object) {
  constexpr std::size_t kMaxGap = 5;  // frames
  std::vector<Points> result(1);
  for (std::size_t i = 0; i < object.path.size(); ++i) {
    const bool gap = i > 0 && object.path[i].frame - object.path[i - 1].frame > kMaxGap;
    if (gap) result.emplace_back();
    result.back().emplace_back(object.path[i].position.head<2>());
  }
  return result;
}

}  // namespace

cv::Mat trackMapPlot(const TrackMap& map) {
  Points all = map.camera_path;
  for (const auto* objects : {&map.truth, &map.tracks}) {
    for (const auto& object : *objects) {
      for (const auto& point : seenFromAbove(object)) all.push_back(point);
    }
  }
  plot::Chart chart(
      {map.title, "x [m]", "y [m]", plot::rangeOf(all, 0), plot::rangeOf(all, 1), true});
  for (const auto& object : map.truth) {
    for (const auto& segment : segments(object)) chart.line(segment, kTrackTruthColour, 6.0);
    chart.dot(object.path.front().position.head<2>(), kTrackTruthColour, 4.0);
  }
  for (const auto& object : map.raw) {
    for (const auto& point : seenFromAbove(object)) chart.dot(point, kRawColour, 1.2);
  }
  for (std::size_t i = 0; i < map.tracks.size(); ++i) {
    for (const auto& segment : segments(map.tracks[i]))
      chart.line(segment, plot::categoryColour(i), 1.6);
  }
  chart.line(map.camera_path, kTrackCameraColour, 1.6, plot::LineStyle::kDotted);
  chart.legend("truth", kTrackTruthColour);
  if (!map.raw.empty()) chart.legend("detector", kRawColour, plot::LineStyle::kDotted);
  chart.legend("tracks, one colour each", plot::categoryColour(0));
  chart.legend("camera", kTrackCameraColour, plot::LineStyle::kDotted);
  return chart.picture();
}

cv::Mat trackPlot(const std::string& title, const TrackErrors& errors) {
  plot::ChartFrame frame{title, "recall [%]", "MOTA, sMOTA [%]", {0, 100}, {0, 100}};
  for (const auto& [object_class, error] : errors.classes) {
    for (const auto& point : error.curve) frame.y.include(std::max(-100.0, 100.0 * point.mota));
  }
  plot::Chart chart(frame);
  std::size_t number = 0;
  for (const auto& [object_class, error] : errors.classes) {
    const Colour colour = plot::categoryColour(number++);
    const std::string name(displayName(object_class));
    const auto percent = [](std::optional<double> ratio) { return plot::percentText(ratio, 1); };
    chart.line(over(error.curve, &RecallPoint::smota), colour, 2.4);
    chart.line(over(error.curve, &RecallPoint::mota), colour, 2.0, plot::LineStyle::kDashed);
    chart.legend(name + " sMOTA (sAMOTA " + percent(error.samota) + ")", colour);
    chart.legend(name + " MOTA (best " + percent(error.mota) + ")", colour,
                 plot::LineStyle::kDashed);
  }
  return chart.picture();
}

}  // namespace headway::eval
