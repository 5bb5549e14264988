// SPDX-License-Identifier: BSD-3-Clause
// Plots of the report: plan view, time bars, timings.
#include <headway/core/error.h>
#include <headway/core/object_class.h>
#include <headway/plot/chart.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "html.h"
#include "sections.h"

namespace headway::report {
namespace {

constexpr double kWidth = 1000.0;  ///< of a plot in SVG units, scaled to the page

/// What the plan view shows.
struct PlanView {
  double min_height = 420.0, max_height = 900.0;   ///< [SVG units]
  double min_margin_m = 3.0, max_margin_m = 18.0;  ///< around the path
  double margin_ratio = 0.35;                      ///< of the path's extent
  double max_track_distance_m = 60.0;              ///< from the path, of tracks inside the plot
};
constexpr PlanView kPlan{};

/// Transformation from the map frame [m] to plot coordinates; x to the right, or upwards if the
/// area is higher than wide.
class PlotFrame {
 public:
  explicit PlotFrame(const Eigen::AlignedBox2d& shown)
      : x_upwards_(shown.sizes().y() > 1.15 * shown.sizes().x()) {
    const Eigen::Vector2d sizes = x_upwards_ ? shown.sizes().reverse().eval() : shown.sizes();
    scale_ = std::min(kWidth / sizes.x(), kPlan.max_height / sizes.y());
    height_ = std::max(kPlan.min_height, sizes.y() * scale_);
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
  double height_ = kPlan.min_height;
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
      if (point.moving && path.exteriorDistance(position) < kPlan.max_track_distance_m) {
        shown.extend(position);
      }
    }
  }
  const double wanted = kPlan.margin_ratio * path.sizes().maxCoeff();
  const Eigen::Vector2d margin =
      Eigen::Vector2d::Constant(std::clamp(wanted, kPlan.min_margin_m, kPlan.max_margin_m));
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

/// Direction of travel over 3 m from a pose on [rad]; 0 at standstill.
double headingFrom(const std::vector<Stamped<Pose>>& path, std::size_t from) {
  for (std::size_t i = from; i < path.size(); ++i) {
    const Eigen::Vector2d way = positionOf(path[i]) - positionOf(path[from]);
    if (way.norm() > 3.0) return std::atan2(way.y(), way.x());
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
      if (std::abs(estimate[i].time - truth.trajectory[j].time) > 0.05) continue;
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

namespace {

constexpr std::size_t kMaxRows = 60;

struct TimeSpan {
  double first = 0.0;
  double last = 0.0;
  [[nodiscard]] double toPlot(double time) const {
    return last > first ? kWidth * (time - first) / (last - first) : 0.0;
  }
};

TimeSpan spanOf(const ReplayFolder& folder) {
  TimeSpan span{1e300, -1e300};
  for (const auto& pose : folder.trajectory) {
    span.first = std::min(span.first, pose.time);
    span.last = std::max(span.last, pose.time);
  }
  for (const auto& history : folder.tracks) {
    span.first = std::min(span.first, history.points.front().time);
    span.last = std::max(span.last, history.points.back().time);
  }
  return span;
}

double lengthOf(const TrackHistory& history) {
  return history.points.back().time - history.points.front().time;
}

std::string rectangle(double from, double to, bool confirmed, bool moving) {
  return "<rect x=\"" + fixed(from, 1) + "\" width=\"" + fixed(std::max(1.5, to - from), 1) +
         (moving ? "\" y=\"0\" height=\"10\"" : "\" y=\"3\" height=\"4\"") +
         (confirmed ? "/>" : " opacity=\".35\"/>");
}

/// One bar per period of constant status and motion state.
std::string bars(const TrackHistory& history, const TimeSpan& span) {
  std::string svg;
  const auto& points = history.points;
  for (std::size_t start = 0, i = 1; i <= points.size(); ++i) {
    const bool gap = i < points.size() && points[i].time - points[i - 1].time > 0.35;  // [s]
    const bool same = i < points.size() && !gap && points[i].confirmed == points[start].confirmed &&
                      points[i].moving == points[start].moving;
    if (same) continue;
    const double end = i < points.size() && !gap ? points[i].time : points[i - 1].time;
    svg += rectangle(span.toPlot(points[start].time), span.toPlot(end), points[start].confirmed,
                     points[start].moving);
    start = i;
  }
  return svg;
}

std::string timeTicks(const TimeSpan& span) {
  const double length = span.last - span.first;
  return "<div class=\"ticks\"><span>0 s</span><span>" + fixed(0.5 * length, 1) +
         " s</span><span>" + fixed(length, 1) + " s</span></div>";
}

std::string timeAxis(const TimeSpan& span) {
  return "<div class=\"row axis\"><span></span>" + timeTicks(span) + "</div>";
}

/// A filled curve over time of evenly spaced values, with axes.
std::string areaPlot(const std::string& title, const std::string& max_text,
                     const std::vector<double>& values, const TimeSpan& span) {
  const double max = std::max(1e-9, *std::max_element(values.begin(), values.end()));
  const double step = plot::tickStep(max, 3.0), top = step * std::ceil(max / step - 1e-9);
  std::string line, lines, heights;
  for (double value = top; value > -0.5 * step; value -= step) {
    lines += "M0 " + fixed(100.0 * (1.0 - value / top), 1) + "H1000";
    heights += "<span>" + plot::tickText(value, step) + "</span>";
  }
  const double last = std::max(1.0, static_cast<double>(values.size()) - 1.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = kWidth * static_cast<double>(i) / last;
    line += (i == 0 ? "M" : "L") + fixed(x, 1) + " " + fixed(100.0 * (1.0 - values[i] / top), 1);
  }
  return "<figure class=\"area\"><figcaption>" + escaped(title) + " <b>max. " + escaped(max_text) +
         "</b></figcaption><div class=\"heights\">" + heights +
         "</div><svg viewBox=\"0 0 1000 100\" preserveAspectRatio=\"none\" role=\"img\" "
         "aria-label=\"" +
         escaped(title) + " over time\"><path class=\"lines\" d=\"" + lines +
         "\"/><path class=\"fill\" d=\"" + line + "L1000 100L0 100Z\"/>" +
         "<path class=\"curve\" d=\"" + line + "\"/></svg>" + timeTicks(span) + "</figure>";
}

/// Mean speed over the last second up to each pose [m/s], as the pictures state it.
std::vector<double> speedsOf(const std::vector<Stamped<Pose>>& path) {
  std::vector<double> speeds;
  for (std::size_t i = 0, first = 0; i < path.size(); ++i) {
    while (first + 1 < i && path[i].time - path[first + 1].time >= 1.0) ++first;
    const double time = path[i].time - path[first].time;
    const double way = (path[i].value.translation() - path[first].value.translation()).norm();
    speeds.push_back(time > 0.0 ? way / time : 0.0);
  }
  return speeds;
}

std::string stageBar(const std::string& name, double median, double p95, double max_ms) {
  const auto width = [&](double ms) { return fixed(kWidth * ms / max_ms, 1); };
  return "<div class=\"row\"><span class=\"name\">" + escaped(name) +
         "</span><svg class=\"stage\" viewBox=\"0 0 1000 10\" preserveAspectRatio=\"none\">"
         "<rect class=\"p95\" y=\"2\" height=\"6\" width=\"" +
         width(p95) + "\"/><rect class=\"median\" y=\"0\" height=\"10\" width=\"" + width(median) +
         "\"/></svg><span class=\"figures\">" + fixed(median, 1) + " / " + fixed(p95, 1) +
         " ms</span></div>";
}

}  // namespace

std::string timeline(const ReplayFolder& folder) {
  if (folder.tracks.empty()) return "";
  std::vector<const TrackHistory*> histories;
  for (const auto& history : folder.tracks) histories.push_back(&history);
  std::stable_sort(
      histories.begin(), histories.end(),
      [](const TrackHistory* a, const TrackHistory* b) { return lengthOf(*a) > lengthOf(*b); });
  const std::size_t omitted = histories.size() - std::min(histories.size(), kMaxRows);
  histories.resize(histories.size() - omitted);
  std::stable_sort(histories.begin(), histories.end(),
                   [](const TrackHistory* a, const TrackHistory* b) {
                     return a->points.front().time < b->points.front().time;
                   });
  const TimeSpan span = spanOf(folder);
  std::string html = "<div class=\"timeline\">";
  for (const TrackHistory* history : histories) {
    const std::string name(displayName(history->object_class));
    html += "<div class=\"row\"><span class=\"name\">" + escaped(name) + " " +
            std::to_string(history->id) + "</span><svg viewBox=\"0 0 1000 10\" fill=\"" +
            hex(colourOf(history->object_class)) + "\" preserveAspectRatio=\"none\">" +
            bars(*history, span) + "</svg></div>";
  }
  html += timeAxis(span) + "</div>";
  if (omitted > 0) {
    html += "<p class=\"note\">" + counted(omitted, "shorter track") +
            (omitted == 1 ? " is" : " are") + " omitted.</p>";
  }
  return html;
}

std::string activityPlots(const ReplayFolder& folder) {
  if (folder.trajectory.size() < 2) return "";
  const TimeSpan span = spanOf(folder);
  const std::vector<double> speeds = speedsOf(folder.trajectory);
  std::string html =
      "<div class=\"plots\">" +
      areaPlot("Speed of the robot [m/s], mean over the last second",
               fixed(*std::max_element(speeds.begin(), speeds.end()), 1) + "\u202fm/s", speeds,
               span);
  std::map<double, double> counts;
  if (folder.track_step == 1) {
    for (const auto& pose : folder.trajectory) counts[pose.time] = 0.0;
  }
  for (const auto& history : folder.tracks) {
    for (const auto& point : history.points) counts[point.time] += 1.0;
  }
  std::vector<double> tracks;
  for (const auto& [time, count] : counts) tracks.push_back(count);
  if (!folder.tracks.empty()) {
    const double most = *std::max_element(tracks.begin(), tracks.end());
    html += areaPlot("Tracks at a time", counted(static_cast<std::size_t>(most), "track"), tracks,
                     span);
  }
  return html + "</div>";
}

std::string timingBars(const ReplayFolder& folder) {
  const auto stages = folder.summary.find("stages_ms");
  if (stages == folder.summary.end() || !stages->is_object() || stages->empty()) return "";
  double max_ms = 1e-9;
  for (const auto& [name, times] : stages->items()) {
    max_ms = std::max(max_ms, times.value("p95", 0.0));
  }
  std::string html = "<div class=\"timings\">";
  for (const auto& [name, times] : stages->items()) {
    html += stageBar(name, times.value("median", 0.0), times.value("p95", 0.0), max_ms);
  }
  html += "<div class=\"row axis\"><span></span><div class=\"ticks\"><span>0 ms</span><span>" +
          fixed(0.5 * max_ms, 1) + " ms</span><span>" + fixed(max_ms, 1) +
          " ms</span></div><span></span></div>";
  return html + "</div>";
}

}  // namespace headway::report
