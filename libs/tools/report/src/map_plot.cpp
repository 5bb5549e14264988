// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/object_class.h>
#include <headway/plot/ticks.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "html.h"
#include "sections.h"

namespace headway::report {
namespace {

constexpr double kWidth = 1000.0;
constexpr double kMinHeight = 420.0, kMaxHeight = 900.0;
constexpr double kMaxMarginM = 18.0;  ///< around the path
constexpr double kMinMarginM = 3.0;
constexpr double kMarginRatio = 0.35;        ///< of the path's extent
constexpr double kMaxTrackDistanceM = 60.0;  ///< from the path, of tracks inside the plot
constexpr double kHeadingBaseM = 3.0;        ///< distance over which the heading is determined
constexpr double kSameTimeS = 0.05;

/// Transformation from the map frame [m] to plot coordinates; x to the right, or upwards if the
/// area is higher than wide.
class PlotFrame {
 public:
  explicit PlotFrame(const Eigen::AlignedBox2d& shown)
      : x_upwards_(shown.sizes().y() > 1.15 * shown.sizes().x()) {
    const Eigen::Vector2d sizes = x_upwards_ ? shown.sizes().reverse().eval() : shown.sizes();
    scale_ = std::min(kWidth / sizes.x(), kMaxHeight / sizes.y());
    height_ = std::max(kMinHeight, sizes.y() * scale_);
    centre_ = shown.center();
  }
  [[nodiscard]] double height() const { return height_; }
  [[nodiscard]] double scale() const { return scale_; }
  [[nodiscard]] Eigen::Vector2d toPlot(const Eigen::Vector2d& position) const {
    const Eigen::Vector2d offset = position - centre_;
    const Eigen::Vector2d rotated = x_upwards_ ? Eigen::Vector2d(-offset.y(), -offset.x())
                                               : Eigen::Vector2d(offset.x(), -offset.y());
    return Eigen::Vector2d(0.5 * kWidth, 0.5 * height_) + scale_ * rotated;
  }
  [[nodiscard]] bool contains(const Eigen::Vector2d& point) const {
    return point.x() >= 0 && point.x() <= kWidth && point.y() >= 0 && point.y() <= height_;
  }

 private:
  bool x_upwards_;
  double scale_ = 1.0;
  double height_ = kMinHeight;
  Eigen::Vector2d centre_;
};

Eigen::Vector2d positionOf(const Stamped<Pose>& pose) { return pose.value.translation().head<2>(); }

Eigen::Vector2d positionOf(const TrackPoint& point) { return {point.x, point.y}; }

std::string coordinates(const Eigen::Vector2d& point) {
  return fixed(point.x(), 1) + " " + fixed(point.y(), 1);
}

Eigen::AlignedBox2d boundsOf(const ReplayFolder& folder) {
  Eigen::AlignedBox2d path;
  for (const auto& pose : folder.trajectory) path.extend(positionOf(pose));
  Eigen::AlignedBox2d shown = path;
  for (const auto& history : folder.tracks) {
    for (const auto& point : history.points) {
      const Eigen::Vector2d position = positionOf(point);
      if (point.moving && path.exteriorDistance(position) < kMaxTrackDistanceM) {
        shown.extend(position);
      }
    }
  }
  const double wanted = kMarginRatio * path.sizes().maxCoeff();
  const Eigen::Vector2d margin =
      Eigen::Vector2d::Constant(std::clamp(wanted, kMinMarginM, kMaxMarginM));
  return {shown.min() - margin, shown.max() + margin};
}

template <typename Points>
std::string polyline(const Points& points, const PlotFrame& frame) {
  std::string d;
  for (const auto& point : points) {
    d += (d.empty() ? "M" : "L") + coordinates(frame.toPlot(positionOf(point)));
  }
  return d;
}

std::string landmarkDots(const std::vector<ColouredPoint>& landmarks, const PlotFrame& frame) {
  std::string d;
  for (const auto& landmark : landmarks) {
    const Eigen::Vector2d point = frame.toPlot(landmark.position.head<2>().cast<double>());
    if (frame.contains(point)) d += "M" + coordinates(point) + "h0";
  }
  return d.empty() ? "" : "<path class=\"dots\" d=\"" + d + "\"/>";
}

/// The occupancy grid below everything else, its pixels mapped to the plot by an affine transform.
std::string occupancy(const std::optional<GridFile>& grid, const PlotFrame& frame) {
  if (!grid) return "";
  const GridPicture picture = gridPicture(grid->picture);
  const auto placeOf = [&](double column, double row) {
    return frame.toPlot(grid->origin +
                        grid->resolution_m * Eigen::Vector2d(column, picture.height - row));
  };
  const Eigen::Vector2d corner = placeOf(0.0, 0.0);
  const Eigen::Vector2d right = placeOf(1.0, 0.0) - corner;
  const Eigen::Vector2d down = placeOf(0.0, 1.0) - corner;
  std::string transform = "matrix(";
  for (const Eigen::Vector2d& part : {right, down, corner}) {
    transform += fixed(part.x(), 4) + " " + fixed(part.y(), 4) + " ";
  }
  transform.back() = ')';
  return "<image class=\"grid\" width=\"" + std::to_string(picture.width) + "\" height=\"" +
         std::to_string(picture.height) + "\" transform=\"" + transform + "\" href=\"" +
         picture.uri + "\"/>";
}

bool isEverMoving(const TrackHistory& history) {
  return std::any_of(history.points.begin(), history.points.end(),
                     [](const TrackPoint& point) { return point.moving; });
}

std::string trackLine(const TrackHistory& history, const PlotFrame& frame) {
  const std::string colour = hex(colourOf(history.object_class));
  const std::string title = "<title>" + escaped(std::string(displayName(history.object_class))) +
                            " " + std::to_string(history.id) + "</title>";
  if (isEverMoving(history)) {
    return "<path class=\"track\" stroke=\"" + colour + "\" d=\"" +
           polyline(history.points, frame) + "\">" + title + "</path>";
  }
  const Eigen::Vector2d last = frame.toPlot(positionOf(history.points.back()));
  if (!frame.contains(last)) return "";
  return "<circle r=\"4\" fill=\"" + colour + "\" cx=\"" + fixed(last.x(), 1) + "\" cy=\"" +
         fixed(last.y(), 1) + "\">" + title + "</circle>";
}

std::string scaleBar(const PlotFrame& frame) {
  const double length = plot::scaleBarLength(0.22 * kWidth / frame.scale());
  const double y = frame.height() - 24.0;
  const double end = 24.0 + length * frame.scale();
  return "<path class=\"bar\" d=\"M24 " + fixed(y, 1) + "H" + fixed(end, 1) +
         "\"/><text class=\"bartext\" x=\"24\" y=\"" + fixed(y - 14.0, 1) + "\">" +
         fixed(length, length < 1.0 ? 1 : 0) + " m</text>";
}

/// Direction of travel from a pose on [rad]; 0 at standstill.
double headingFrom(const std::vector<Stamped<Pose>>& path, std::size_t from) {
  for (std::size_t i = from; i < path.size(); ++i) {
    const Eigen::Vector2d way = positionOf(path[i]) - positionOf(path[from]);
    if (way.norm() > kHeadingBaseM) return std::atan2(way.y(), way.x());
  }
  return 0.0;
}

}  // namespace

std::string mapPlot(const ReplayFolder& folder, const TruthLayer& truth) {
  if (folder.trajectory.empty()) return "";
  const PlotFrame frame(boundsOf(folder));
  std::string svg = "<svg class=\"map\" viewBox=\"0 0 1000 " + fixed(frame.height(), 0) +
                    "\" role=\"img\" aria-label=\"Plan view of the map\">" +
                    occupancy(folder.grid, frame) + landmarkDots(folder.landmarks, frame);
  for (const auto& history : truth.objects) {
    if (isEverMoving(history)) {
      svg += "<path class=\"truthtrack\" d=\"" + polyline(history.points, frame) + "\"/>";
    }
  }
  for (const auto& history : folder.tracks) svg += trackLine(history, frame);
  if (!truth.trajectory.empty()) {
    svg += "<path class=\"truth\" d=\"" + polyline(truth.trajectory, frame) + "\"/>";
  }
  const Eigen::Vector2d start = frame.toPlot(positionOf(folder.trajectory.front()));
  svg += "<path class=\"robot\" d=\"" + polyline(folder.trajectory, frame) + "\"/>";
  svg += "<circle class=\"start\" r=\"8\" cx=\"" + fixed(start.x(), 1) + "\" cy=\"" +
         fixed(start.y(), 1) + "\"/>" + scaleBar(frame) + "</svg>";
  return svg;
}

void alignToEstimate(const std::vector<Stamped<Pose>>& estimate, const std::string& truth_name,
                     TruthLayer& truth) {
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    for (std::size_t j = 0; j < truth.trajectory.size(); ++j) {
      if (std::abs(estimate[i].time - truth.trajectory[j].time) > kSameTimeS) continue;
      const Eigen::Vector2d from = positionOf(truth.trajectory[j]);
      const Eigen::Vector2d to = positionOf(estimate[i]);
      const Eigen::Rotation2Dd rotation(headingFrom(estimate, i) -
                                        headingFrom(truth.trajectory, j));
      const auto moved = [&](const Eigen::Vector2d& point) {
        return Eigen::Vector2d(to + rotation * (point - from));
      };
      for (auto& pose : truth.trajectory) {
        pose.value.translation().head<2>() = moved(positionOf(pose));
      }
      for (auto& history : truth.objects) {
        for (auto& point : history.points) {
          const Eigen::Vector2d position = moved(positionOf(point));
          point.x = position.x();
          point.y = position.y();
        }
      }
      return;
    }
  }
  throw InputError(truth_name + ": no time agrees with a time of the replay");
}

}  // namespace headway::report
