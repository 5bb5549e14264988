#include "map_plot.h"

#include <headway/core/error.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "html.h"

namespace headway::report {
namespace {

constexpr double kWidth = 1000.0;
constexpr double kLowest = 420.0, kHighest = 900.0;  ///< of the plot's height
constexpr double kMarginM = 18.0;                    ///< shown around the path
constexpr double kTrackReachM = 60.0;  ///< from the path; farther ones do not widen it
constexpr double kHeadingBaseM = 3.0;  ///< way over which a heading is measured
constexpr double kSameTimeS = 0.05;

/// From metres to the plot's units; x to the right, or up where the path runs that way.
class Frame {
 public:
  Frame(Eigen::AlignedBox2d shown) : upright_(shown.sizes().y() > 1.15 * shown.sizes().x()) {
    const Eigen::Vector2d sizes = upright_ ? shown.sizes().reverse().eval() : shown.sizes();
    scale_ = std::min(kWidth / sizes.x(), kHighest / sizes.y());
    height_ = std::max(kLowest, sizes.y() * scale_);
    middle_ = shown.center();
  }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] Eigen::Vector2d at(double x, double y) const {
    const Eigen::Vector2d offset = Eigen::Vector2d(x, y) - middle_;
    const Eigen::Vector2d turned = upright_ ? Eigen::Vector2d(-offset.y(), -offset.x())
                                            : Eigen::Vector2d(offset.x(), -offset.y());
    return Eigen::Vector2d(0.5 * kWidth, 0.5 * height_) + scale_ * turned;
  }
  [[nodiscard]] bool shows(const Eigen::Vector2d& point) const {
    return point.x() >= 0 && point.x() <= kWidth && point.y() >= 0 && point.y() <= height_;
  }

 private:
  bool upright_;
  double scale_ = 1.0;
  double height_ = kLowest;
  Eigen::Vector2d middle_;
};

std::string coordinates(const Eigen::Vector2d& point) {
  return fixed(point.x(), 1) + " " + fixed(point.y(), 1);
}

Eigen::AlignedBox2d boundsOf(const ReplayFolder& folder) {
  Eigen::AlignedBox2d path;
  for (const auto& place : folder.trajectory) path.extend(Eigen::Vector2d(place.x, place.y));
  Eigen::AlignedBox2d shown = path;
  for (const auto& life : folder.tracks) {
    for (const auto& point : life.points) {
      const Eigen::Vector2d place(point.x, point.y);
      if (point.moving && path.exteriorDistance(place) < kTrackReachM) shown.extend(place);
    }
  }
  const Eigen::Vector2d margin = Eigen::Vector2d::Constant(kMarginM);
  return {shown.min() - margin, shown.max() + margin};
}

template <typename Points>
std::string polyline(const Points& points, const Frame& frame) {
  std::string d;
  for (const auto& point : points) {
    d += (d.empty() ? "M" : "L") + coordinates(frame.at(point.x, point.y));
  }
  return d;
}

std::string landmarkDots(const std::vector<Eigen::Vector3f>& landmarks, const Frame& frame) {
  std::string d;
  for (const auto& landmark : landmarks) {
    const Eigen::Vector2d point = frame.at(landmark.x(), landmark.y());
    if (frame.shows(point)) d += "M" + coordinates(point) + "h0";
  }
  return d.empty() ? "" : "<path class=\"dots\" d=\"" + d + "\"/>";
}

bool everMoves(const TrackLife& life) {
  return std::any_of(life.points.begin(), life.points.end(),
                     [](const TrackPoint& point) { return point.moving; });
}

std::string trackLine(const TrackLife& life, const Frame& frame) {
  const std::string colour = hex(colourOf(life.object_class));
  const std::string title = "<title>" + escaped(std::string(toString(life.object_class))) + " " +
                            std::to_string(life.id) + "</title>";
  if (everMoves(life)) {
    return "<path class=\"track\" stroke=\"" + colour + "\" d=\"" + polyline(life.points, frame) +
           "\">" + title + "</path>";
  }
  const Eigen::Vector2d last = frame.at(life.points.back().x, life.points.back().y);
  if (!frame.shows(last)) return "";
  return "<circle r=\"4\" fill=\"" + colour + "\" cx=\"" + fixed(last.x(), 1) + "\" cy=\"" +
         fixed(last.y(), 1) + "\">" + title + "</circle>";
}

std::string scaleBar(const Frame& frame) {
  const double most = 0.22 * kWidth / frame.scale();
  const double power = std::pow(10.0, std::floor(std::log10(most)));
  const double length = (most >= 5.0 * power ? 5.0 : most >= 2.0 * power ? 2.0 : 1.0) * power;
  const double y = frame.height() - 24.0;
  const double end = 24.0 + length * frame.scale();
  return "<path class=\"bar\" d=\"M24 " + fixed(y, 1) + "H" + fixed(end, 1) +
         "\"/><text class=\"bartext\" x=\"24\" y=\"" + fixed(y - 14.0, 1) + "\">" +
         fixed(length, length < 1.0 ? 1 : 0) + " m</text>";
}

/// Direction of travel at the beginning of a path [rad]; 0 where it stands still.
double firstHeading(const std::vector<TimedPlace>& path, std::size_t from) {
  for (std::size_t i = from; i < path.size(); ++i) {
    const double dx = path[i].x - path[from].x;
    const double dy = path[i].y - path[from].y;
    if (std::hypot(dx, dy) > kHeadingBaseM) return std::atan2(dy, dx);
  }
  return 0.0;
}

}  // namespace

std::string mapPlot(const ReplayFolder& folder, const TruthLayer& truth) {
  if (folder.trajectory.empty()) return "";
  const Frame frame(boundsOf(folder));
  std::string svg = "<svg class=\"map\" viewBox=\"0 0 1000 " + fixed(frame.height(), 0) +
                    "\" role=\"img\" aria-label=\"Map from above\">" +
                    landmarkDots(folder.landmarks, frame);
  for (const auto& life : truth.objects) {
    if (everMoves(life)) {
      svg += "<path class=\"truthtrack\" d=\"" + polyline(life.points, frame) + "\"/>";
    }
  }
  for (const auto& life : folder.tracks) svg += trackLine(life, frame);
  if (!truth.trajectory.empty()) {
    svg += "<path class=\"truth\" d=\"" + polyline(truth.trajectory, frame) + "\"/>";
  }
  const auto& first = folder.trajectory.front();
  const Eigen::Vector2d start = frame.at(first.x, first.y);
  svg += "<path class=\"robot\" d=\"" + polyline(folder.trajectory, frame) + "\"/>";
  svg += "<circle class=\"start\" r=\"8\" cx=\"" + fixed(start.x(), 1) + "\" cy=\"" +
         fixed(start.y(), 1) + "\"/>" + scaleBar(frame) + "</svg>";
  return svg;
}

void layOnto(const std::vector<TimedPlace>& estimate, const std::string& truth_name,
             TruthLayer& truth) {
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    for (std::size_t j = 0; j < truth.trajectory.size(); ++j) {
      if (std::abs(estimate[i].time - truth.trajectory[j].time) > kSameTimeS) continue;
      const Eigen::Vector2d from(truth.trajectory[j].x, truth.trajectory[j].y);
      const Eigen::Vector2d to(estimate[i].x, estimate[i].y);
      const Eigen::Rotation2Dd turn(firstHeading(estimate, i) - firstHeading(truth.trajectory, j));
      const auto move = [&](auto& point) {
        const Eigen::Vector2d moved = to + turn * (Eigen::Vector2d(point.x, point.y) - from);
        point.x = moved.x();
        point.y = moved.y();
      };
      for (auto& place : truth.trajectory) move(place);
      for (auto& life : truth.objects) {
        for (auto& point : life.points) move(point);
      }
      return;
    }
  }
  throw InputError(truth_name + ": none of its times is one of the replay's");
}

}  // namespace headway::report
