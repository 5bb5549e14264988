// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/plots.h>
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>
#include <headway/plot/text_table.h>

#include <algorithm>
#include <array>
#include <cstdio>

namespace headway::eval {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr Colour kTruthColour{60, 60, 60};

Points seenFromAbove(const std::vector<PosePair>& pairs, Pose PosePair::*which, TopView view) {
  Points points;
  for (const auto& pair : pairs) {
    const Eigen::Vector3d at = (pair.*which).translation();
    points.emplace_back(at.x(), view == TopView::kXy ? at.y() : at.z());
  }
  return points;
}

cv::Mat pathFromAbove(const TrajectoryError& error, TopView view, const std::string& title) {
  const auto truth = seenFromAbove(error.aligned, &PosePair::truth, view);
  const auto estimate = seenFromAbove(error.aligned, &PosePair::estimate, view);
  Points both = truth;
  both.insert(both.end(), estimate.begin(), estimate.end());
  plot::ChartFrame frame{title,
                         "x [m]",
                         view == TopView::kXy ? "y [m]" : "z [m]",
                         plot::rangeOf(both, 0),
                         plot::rangeOf(both, 1),
                         true};
  frame.right_px = plot::kRampWidth_px;
  plot::Chart chart(frame);
  chart.line(truth, kTruthColour, 1.6, plot::LineStyle::kDashed);
  const double greatest = std::max(error.ate_m.max, 1e-9);
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    chart.line({estimate[i - 1], estimate[i]}, plot::rampColour(error.errors_m[i] / greatest), 3.0);
  }
  chart.ring(truth.front(), kTruthColour);
  chart.text(truth.front(), "start", kTruthColour);
  chart.dot(truth.back(), kTruthColour, 5.0);
  chart.text(truth.back(), "end", kTruthColour);
  chart.legend("truth", kTruthColour, plot::LineStyle::kDashed);
  chart.legend("estimate, coloured by error", plot::rampColour(0.5));
  chart.ramp("position error [m]", greatest);
  return chart.picture();
}

cv::Mat errorOverPath(const TrajectoryError& error) {
  const auto distances = trueDistances(error.aligned);
  Points points;
  for (std::size_t i = 0; i < distances.size(); ++i) {
    points.emplace_back(distances[i], error.errors_m[i]);
  }
  std::array<char, 160> words{};
  std::snprintf(words.data(), words.size(),
                "RMSE %.4f m   mean %.4f   median %.4f   SD %.4f   max %.4f m", error.ate_m.rmse,
                error.ate_m.mean, error.ate_m.median, error.ate_m.sd, error.ate_m.max);
  plot::ChartFrame frame{words.data(),
                         "true path [m]",
                         "error [m]",
                         {0.0, error.path_m},
                         {0.0, std::max(error.ate_m.max, 1e-9)}};
  frame.height = 340;
  frame.right_px = plot::kRampWidth_px;
  plot::Chart chart(frame);
  chart.line({{0.0, error.ate_m.rmse}, {error.path_m, error.ate_m.rmse}}, plot::categoryColour(1),
             1.6, plot::LineStyle::kDashed);
  chart.line(points, plot::categoryColour(0), 2.0);
  chart.legend("error", plot::categoryColour(0));
  chart.legend("RMSE", plot::categoryColour(1), plot::LineStyle::kDashed);
  return chart.picture();
}

}  // namespace

cv::Mat trajectoryPlot(const TrajectoryError& error, TopView view, const std::string& title) {
  return plot::stacked({pathFromAbove(error, view, title), errorOverPath(error)});
}

}  // namespace headway::eval
