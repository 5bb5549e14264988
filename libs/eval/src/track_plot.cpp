#include <headway/eval/chart.h>
#include <headway/eval/text_table.h>
#include <headway/eval/track_plot.h>

namespace headway::eval {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points over(const std::vector<RecallPoint>& curve, double RecallPoint::*figure) {
  Points points;
  for (const auto& point : curve) points.emplace_back(100.0 * point.recall, 100.0 * point.*figure);
  return points;
}

constexpr Colour kTruthColour{170, 205, 235};
constexpr Colour kRawColour{150, 150, 150};
constexpr Colour kCameraColour{110, 110, 110};

Points seenFromAbove(const TrueObject& object) {
  Points points;
  for (const auto& point : object.path) points.emplace_back(point.position.head<2>());
  return points;
}

/// The object's places, with a break where it was away for longer than a few frames.
std::vector<Points> pieces(const TrueObject& object) {
  constexpr std::size_t kLongestGap = 5;  // frames
  std::vector<Points> result(1);
  for (std::size_t i = 0; i < object.path.size(); ++i) {
    const bool gap = i > 0 && object.path[i].frame - object.path[i - 1].frame > kLongestGap;
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
  Chart chart({map.title, "x [m]", "y [m]", rangeOf(all, 0), rangeOf(all, 1), true});
  for (const auto& object : map.truth) {
    for (const auto& piece : pieces(object)) chart.line(piece, kTruthColour, 6.0);
    chart.dot(object.path.front().position.head<2>(), kTruthColour, 4.0);
  }
  for (const auto& object : map.raw) {
    for (const auto& point : seenFromAbove(object)) chart.dot(point, kRawColour, 1.2);
  }
  for (std::size_t i = 0; i < map.tracks.size(); ++i) {
    for (const auto& piece : pieces(map.tracks[i])) chart.line(piece, categoryColour(i), 1.6);
  }
  chart.line(map.camera_path, kCameraColour, 1.6, LineStyle::kDotted);
  chart.legend("truth", kTruthColour);
  if (!map.raw.empty()) chart.legend("detector", kRawColour, LineStyle::kDotted);
  chart.legend("tracks, a colour each", categoryColour(0));
  chart.legend("camera", kCameraColour, LineStyle::kDotted);
  return chart.picture();
}

cv::Mat trackPlot(const TrackErrors& errors) {
  ChartFrame frame{"Accuracy over recall", "recall [%]", "MOTA, sMOTA [%]", {0, 100}, {0, 100}};
  for (const auto& [object_class, error] : errors.classes) {
    for (const auto& point : error.curve) frame.y.include(std::max(-100.0, 100.0 * point.mota));
  }
  Chart chart(frame);
  std::size_t number = 0;
  for (const auto& [object_class, error] : errors.classes) {
    const Colour colour = categoryColour(number++);
    const std::string name(toString(object_class));
    const auto percent = [](std::optional<double> share) {
      return share ? fixedText(100.0 * *share, 1) : fixedText(share, 1);
    };
    chart.line(over(error.curve, &RecallPoint::smota), colour, 2.4);
    chart.line(over(error.curve, &RecallPoint::mota), colour, 2.0, LineStyle::kDashed);
    chart.legend(name + " sMOTA (sAMOTA " + percent(error.samota) + ")", colour);
    chart.legend(name + " MOTA (best " + percent(error.mota) + ")", colour, LineStyle::kDashed);
  }
  return chart.picture();
}

}  // namespace headway::eval
