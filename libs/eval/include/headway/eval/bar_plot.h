#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

namespace headway::eval {

/// One colour of bars.
struct BarSeries {
  std::string name;
  std::vector<double> values;  ///< one a group; what is not finite is left out
};

/// Bars in groups that stand side by side.
struct BarPlot {
  std::string title;
  std::string y_label;
  std::vector<std::string> groups;
  std::vector<BarSeries> series;
};

/// Draws the bars from zero up. 8-bit BGR.
[[nodiscard]] cv::Mat barPlot(const BarPlot& plot);

}  // namespace headway::eval
