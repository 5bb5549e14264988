#include <headway/eval/bar_plot.h>
#include <headway/eval/chart.h>

#include <cmath>

namespace headway::eval {
namespace {

constexpr double kGroupShare = 0.84;  // of the room of a group that its bars take

}  // namespace

cv::Mat barPlot(const BarPlot& plot) {
  ChartFrame frame{plot.title, "", plot.y_label, {0.0, 1.0}, {0.0, 0.0}};
  frame.x.max = std::max(1.0, static_cast<double>(plot.groups.size()));
  frame.height = 460;
  frame.right_px = kLegendRoom_px;
  frame.legend_beside = true;  // bars may fill every corner
  frame.x_names = plot.groups;
  for (const auto& series : plot.series) {
    for (const double value : series.values) frame.y.include(value);
  }
  if (!(frame.y.max > 0.0)) frame.y.max = 1.0;
  Chart chart(frame);
  const double width =
      kGroupShare / static_cast<double>(std::max<std::size_t>(1, plot.series.size()));
  for (std::size_t s = 0; s < plot.series.size(); ++s) {
    const auto& [name, values] = plot.series[s];
    for (std::size_t g = 0; g < values.size(); ++g) {
      if (!std::isfinite(values[g])) continue;
      const double left =
          static_cast<double>(g) + 0.5 * (1.0 - kGroupShare) + width * static_cast<double>(s);
      chart.bar(left, left + 0.92 * width, values[g], categoryColour(s));
    }
    chart.legend(name, categoryColour(s));
  }
  return chart.picture();
}

}  // namespace headway::eval
