// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/object_class.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "html.h"
#include "sections.h"

namespace headway::report {
namespace {

constexpr std::size_t kMaxRows = 60;
constexpr double kUnits = 1000.0;  ///< width of a plot in SVG units, scaled to the page
constexpr double kGapS = 0.35;     ///< a longer time between rows interrupts the bar

struct TimeSpan {
  double first = 0.0;
  double last = 0.0;
  [[nodiscard]] double toPlot(double time) const {
    return last > first ? kUnits * (time - first) / (last - first) : 0.0;
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
    const bool gap = i < points.size() && points[i].time - points[i - 1].time > kGapS;
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

std::string timeAxis(const TimeSpan& span) {
  const double length = span.last - span.first;
  return "<div class=\"row axis\"><span></span><div class=\"ticks\"><span>0 s</span><span>" +
         fixed(0.5 * length, 1) + " s</span><span>" + fixed(length, 1) + " s</span></div></div>";
}

/// A filled curve over time of evenly spaced values.
std::string areaPlot(const std::string& title, const std::string& unit,
                     const std::vector<double>& values, int decimals, const TimeSpan& span) {
  const double top = std::max(1e-9, *std::max_element(values.begin(), values.end()));
  const double last = std::max(1.0, static_cast<double>(values.size()) - 1.0);
  std::string line;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = kUnits * static_cast<double>(i) / last;
    line += (i == 0 ? "M" : "L") + fixed(x, 1) + " " + fixed(100.0 - 92.0 * values[i] / top, 1);
  }
  return "<figure class=\"area\"><figcaption>" + escaped(title) + " <b>max. " +
         fixed(top, decimals) + "\u202f" + escaped(unit) +
         "</b></figcaption><svg viewBox=\"0 0 1000 100\" preserveAspectRatio=\"none\" role=\"img\" "
         "aria-label=\"" +
         escaped(title) + " over time\"><path class=\"fill\" d=\"" + line + "L1000 100L0 100Z\"/>" +
         "<path class=\"curve\" d=\"" + line + "\"/></svg><div class=\"ticks\"><span>0 s</span>" +
         "<span>" + fixed(span.last - span.first, 1) + " s</span></div></figure>";
}

/// Mean speed within 0.5 s before and after each pose [m/s].
std::vector<double> speedsOf(const std::vector<Stamped<Pose>>& path) {
  std::vector<double> speeds;
  for (std::size_t i = 0, low = 0, high = 0; i < path.size(); ++i) {
    while (path[i].time - path[low].time > 0.5) ++low;
    while (high + 1 < path.size() && path[high].time - path[i].time < 0.5) ++high;
    const double time = path[high].time - path[low].time;
    const double way =
        (path[high].value.translation() - path[low].value.translation()).head<2>().norm();
    speeds.push_back(time > 0.0 ? way / time : 0.0);
  }
  return speeds;
}

std::string stageBar(const std::string& name, double median, double p95, double max_ms) {
  const auto width = [&](double ms) { return fixed(kUnits * ms / max_ms, 1); };
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
    html += "<p class=\"note\">" + grouped(omitted) + " shorter tracks are omitted.</p>";
  }
  return html;
}

std::string activityPlots(const ReplayFolder& folder) {
  if (folder.trajectory.size() < 2) return "";
  const TimeSpan span = spanOf(folder);
  std::string html = "<div class=\"plots\">" +
                     areaPlot("Speed of the robot", "m/s", speedsOf(folder.trajectory), 1, span);
  std::map<double, double> counts;
  for (const auto& pose : folder.trajectory) counts[pose.time] = 0.0;
  for (const auto& history : folder.tracks) {
    for (const auto& point : history.points) counts[point.time] += 1.0;
  }
  std::vector<double> tracks;
  for (const auto& [time, count] : counts) tracks.push_back(count);
  if (!folder.tracks.empty()) html += areaPlot("Tracks at a time", "tracks", tracks, 0, span);
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
  return html + "</div>";
}

}  // namespace headway::report
