#include "timeline.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "html.h"

namespace headway::report {
namespace {

constexpr std::size_t kMostRows = 60;
constexpr double kUnits = 1000.0;  ///< width of a plot, stretched to the page
constexpr double kGapS = 0.35;     ///< a longer time between two rows is a gap in the bar

struct Span {
  double first = 0.0;
  double last = 0.0;
  [[nodiscard]] double share(double time) const {
    return last > first ? kUnits * (time - first) / (last - first) : 0.0;
  }
};

Span spanOf(const ReplayFolder& folder) {
  Span span{1e300, -1e300};
  for (const auto& place : folder.trajectory) {
    span.first = std::min(span.first, place.time);
    span.last = std::max(span.last, place.time);
  }
  for (const auto& life : folder.tracks) {
    span.first = std::min(span.first, life.points.front().time);
    span.last = std::max(span.last, life.points.back().time);
  }
  return span;
}

double lengthOf(const TrackLife& life) {
  return life.points.back().time - life.points.front().time;
}

std::string rectangle(double from, double to, bool confirmed, bool moving) {
  return "<rect x=\"" + fixed(from, 1) + "\" width=\"" + fixed(std::max(1.5, to - from), 1) +
         (moving ? "\" y=\"0\" height=\"10\"" : "\" y=\"3\" height=\"4\"") +
         (confirmed ? "/>" : " opacity=\".35\"/>");
}

/// Bars over the pieces of a life in which neither verdict changes.
std::string bars(const TrackLife& life, const Span& span) {
  std::string svg;
  const auto& points = life.points;
  for (std::size_t start = 0, i = 1; i <= points.size(); ++i) {
    const bool gap = i < points.size() && points[i].time - points[i - 1].time > kGapS;
    const bool same = i < points.size() && !gap && points[i].confirmed == points[start].confirmed &&
                      points[i].moving == points[start].moving;
    if (same) continue;
    const double end = i < points.size() && !gap ? points[i].time : points[i - 1].time;
    svg += rectangle(span.share(points[start].time), span.share(end), points[start].confirmed,
                     points[start].moving);
    start = i;
  }
  return svg;
}

std::string timeAxis(const Span& span) {
  const double length = span.last - span.first;
  return "<div class=\"row axis\"><span></span><div class=\"ticks\"><span>0 s</span><span>" +
         fixed(0.5 * length, 1) + " s</span><span>" + fixed(length, 1) + " s</span></div></div>";
}

/// A filled curve over time; values are spread evenly over the plot's width.
std::string areaPlot(const std::string& title, const std::string& unit,
                     const std::vector<double>& values, int decimals, const Span& span) {
  const double top = std::max(1e-9, *std::max_element(values.begin(), values.end()));
  const double last = std::max(1.0, static_cast<double>(values.size()) - 1.0);
  std::string line;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double x = kUnits * static_cast<double>(i) / last;
    line += (i == 0 ? "M" : "L") + fixed(x, 1) + " " + fixed(100.0 - 92.0 * values[i] / top, 1);
  }
  return "<figure class=\"area\"><figcaption>" + escaped(title) + " <b>up to " +
         fixed(top, decimals) + "\u202f" + escaped(unit) +
         "</b></figcaption><svg viewBox=\"0 0 1000 100\" preserveAspectRatio=\"none\" role=\"img\" "
         "aria-label=\"" +
         escaped(title) + " over time\"><path class=\"fill\" d=\"" + line + "L1000 100L0 100Z\"/>" +
         "<path class=\"curve\" d=\"" + line + "\"/></svg><div class=\"ticks\"><span>0 s</span>" +
         "<span>" + fixed(span.last - span.first, 1) + " s</span></div></figure>";
}

/// Mean speed over a window of half a second to each side [m/s].
std::vector<double> speedsOf(const std::vector<TimedPlace>& path) {
  std::vector<double> speeds;
  for (std::size_t i = 0, low = 0, high = 0; i < path.size(); ++i) {
    while (path[i].time - path[low].time > 0.5) ++low;
    while (high + 1 < path.size() && path[high].time - path[i].time < 0.5) ++high;
    const double time = path[high].time - path[low].time;
    const double way = std::hypot(path[high].x - path[low].x, path[high].y - path[low].y);
    speeds.push_back(time > 0.0 ? way / time : 0.0);
  }
  return speeds;
}

std::string stageBar(const std::string& name, double median, double p95, double longest) {
  const auto share = [&](double ms) { return fixed(kUnits * ms / longest, 1); };
  return "<div class=\"row\"><span class=\"name\">" + escaped(name) +
         "</span><svg class=\"stage\" viewBox=\"0 0 1000 10\" preserveAspectRatio=\"none\">"
         "<rect class=\"p95\" y=\"2\" height=\"6\" width=\"" +
         share(p95) + "\"/><rect class=\"median\" y=\"0\" height=\"10\" width=\"" + share(median) +
         "\"/></svg><span class=\"figures\">" + fixed(median, 1) + " / " + fixed(p95, 1) +
         " ms</span></div>";
}

}  // namespace

std::string timeline(const ReplayFolder& folder) {
  if (folder.tracks.empty()) return "";
  std::vector<const TrackLife*> lives;
  for (const auto& life : folder.tracks) lives.push_back(&life);
  std::stable_sort(lives.begin(), lives.end(), [](const TrackLife* a, const TrackLife* b) {
    return lengthOf(*a) > lengthOf(*b);
  });
  const std::size_t left_out = lives.size() - std::min(lives.size(), kMostRows);
  lives.resize(lives.size() - left_out);
  std::stable_sort(lives.begin(), lives.end(), [](const TrackLife* a, const TrackLife* b) {
    return a->points.front().time < b->points.front().time;
  });
  const Span span = spanOf(folder);
  std::string html = "<div class=\"timeline\">";
  for (const TrackLife* life : lives) {
    const std::string name(toString(life->object_class));
    html += "<div class=\"row\"><span class=\"name\">" + escaped(name) + " " +
            std::to_string(life->id) + "</span><svg viewBox=\"0 0 1000 10\" fill=\"" +
            hex(colourOf(life->object_class)) + "\" preserveAspectRatio=\"none\">" +
            bars(*life, span) + "</svg></div>";
  }
  html += timeAxis(span) + "</div>";
  if (left_out > 0) {
    html += "<p class=\"note\">" + grouped(left_out) + " shorter tracks are not shown.</p>";
  }
  return html;
}

std::string activityPlots(const ReplayFolder& folder) {
  if (folder.trajectory.size() < 2) return "";
  const Span span = spanOf(folder);
  std::string html = "<div class=\"plots\">" +
                     areaPlot("Speed of the robot", "m/s", speedsOf(folder.trajectory), 1, span);
  std::map<double, double> counts;
  for (const auto& place : folder.trajectory) counts[place.time] = 0.0;
  for (const auto& life : folder.tracks) {
    for (const auto& point : life.points) counts[point.time] += 1.0;
  }
  std::vector<double> tracks;
  for (const auto& [time, count] : counts) tracks.push_back(count);
  if (!folder.tracks.empty()) html += areaPlot("Tracks at a time", "tracks", tracks, 0, span);
  return html + "</div>";
}

std::string timingBars(const ReplayFolder& folder) {
  const auto stages = folder.summary.find("stages_ms");
  if (stages == folder.summary.end() || !stages->is_object() || stages->empty()) return "";
  double longest = 1e-9;
  for (const auto& [name, times] : stages->items()) {
    longest = std::max(longest, times.value("p95", 0.0));
  }
  std::string html = "<div class=\"timings\">";
  for (const auto& [name, times] : stages->items()) {
    html += stageBar(name, times.value("median", 0.0), times.value("p95", 0.0), longest);
  }
  return html + "</div>";
}

}  // namespace headway::report
