// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/plots.h>
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>
#include <headway/plot/text_table.h>
namespace headway::eval {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr Colour kCameraColour{150, 150, 150};
constexpr Colour kPredictionColour{20, 20, 20};
constexpr double kMinPathExtent_m = 1.0;  // objects that move less are drawn as dots

Points truePath(const TrueObject& object) {
  Points points;
  for (const auto& point : object.path) points.emplace_back(point.position.head<2>());
  return points;
}

Points predictedPath(const Eigen::Vector2d& now, const PredictedPath& path) {
  Points points = {now};
  for (const auto& point : path.points) points.emplace_back(point.position.head<2>());
  return points;
}

void append(Points& all, const Points& more) { all.insert(all.end(), more.begin(), more.end()); }

void drawTruth(plot::Chart& chart, const TrueObject& object, Colour colour) {
  const auto points = truePath(object);
  const double extent = std::max(plot::rangeOf(points, 0).size(), plot::rangeOf(points, 1).size());
  if (extent < kMinPathExtent_m) {
    chart.dot(points.front(), colour, 3.0);
  } else {
    chart.line(points, plot::lightened(colour), 5.0);
  }
}

}  // namespace

cv::Mat predictionMapPlot(const std::string& title, const std::vector<TrueObject>& objects,
                          const std::vector<DrawnPrediction>& predictions,
                          const std::vector<Eigen::Vector2d>& camera_path) {
  Points all = camera_path;
  for (const auto& object : objects) append(all, truePath(object));
  plot::Chart chart({title, "x [m]", "y [m]", plot::rangeOf(all, 0), plot::rangeOf(all, 1), true});
  chart.line(camera_path, kCameraColour, 2.0, plot::LineStyle::kDotted);
  for (std::size_t i = 0; i < objects.size(); ++i)
    drawTruth(chart, objects[i], plot::categoryColour(i));
  for (const auto& prediction : predictions) {
    for (std::size_t k = prediction.paths.size(); k-- > 0;) {
      chart.line(predictedPath(prediction.now, prediction.paths[k]), kPredictionColour,
                 k == 0 ? 1.6 : 0.8, plot::LineStyle::kDashed);
    }
    chart.dot(prediction.now, plot::categoryColour(prediction.object), 4.0);
  }
  chart.legend("true paths, one colour each", plot::lightened(plot::categoryColour(0)));
  chart.legend("predicted, 3 s", kPredictionColour, plot::LineStyle::kDashed);
  chart.legend("camera", kCameraColour, plot::LineStyle::kDotted);
  return chart.picture();
}

cv::Mat errorOverHorizonPlot(
    const std::string& title,
    const std::vector<std::pair<std::string, PredictionError>>& predictors) {
  plot::ChartFrame frame{title, "horizon [s]", "mean error [m]", {0, 3}, {0, 0.1}};
  for (const auto& [name, error] : predictors) frame.y.include(error.mean_error_m.back());
  frame.height = 460;
  plot::Chart chart(frame);
  std::size_t number = 0;
  for (const auto& [name, error] : predictors) {
    Points points;
    for (std::size_t j = 0; j < kHorizons; ++j) {
      points.emplace_back(kHorizonStep_s * static_cast<double>(j + 1), error.mean_error_m[j]);
    }
    const auto style = number < 8 ? plot::LineStyle::kSolid : plot::LineStyle::kDashed;
    chart.line(points, plot::categoryColour(number), 2.2, style);
    chart.legend(name + ": ADE " + plot::fixedText(error.ade_m, 3) + " m, FDE " +
                     plot::fixedText(error.fde_m, 3) + " m",
                 plot::categoryColour(number), style);
    ++number;
  }
  return chart.picture();
}

}  // namespace headway::eval
