#include <headway/eval/chart.h>
#include <headway/eval/prediction_plot.h>
#include <headway/eval/text_table.h>

namespace headway::eval {
namespace {

using Points = std::vector<Eigen::Vector2d>;

constexpr Colour kCameraColour{150, 150, 150};
constexpr Colour kPredictionColour{20, 20, 20};
constexpr double kWorthDrawing_m = 1.0;  // objects that move less are dots

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

/// Half way to white.
Colour paler(Colour colour) {
  const auto half = [](std::uint8_t value) { return static_cast<std::uint8_t>((value + 255) / 2); };
  return {half(colour.red), half(colour.green), half(colour.blue)};
}

void append(Points& all, const Points& more) { all.insert(all.end(), more.begin(), more.end()); }

void drawTruth(Chart& chart, const TrueObject& object, Colour colour) {
  const auto points = truePath(object);
  const double extent = std::max(rangeOf(points, 0).size(), rangeOf(points, 1).size());
  if (extent < kWorthDrawing_m) {
    chart.dot(points.front(), colour, 3.0);
  } else {
    chart.line(points, paler(colour), 5.0);
  }
}

}  // namespace

cv::Mat predictionMapPlot(const std::string& title, const std::vector<TrueObject>& objects,
                          const std::vector<DrawnPrediction>& predictions,
                          const std::vector<Eigen::Vector2d>& camera_path) {
  Points all = camera_path;
  for (const auto& object : objects) append(all, truePath(object));
  Chart chart({title, "x [m]", "y [m]", rangeOf(all, 0), rangeOf(all, 1), true});
  chart.line(camera_path, kCameraColour, 2.0, LineStyle::kDotted);
  for (std::size_t i = 0; i < objects.size(); ++i) drawTruth(chart, objects[i], categoryColour(i));
  for (const auto& prediction : predictions) {
    for (std::size_t k = prediction.paths.size(); k-- > 0;) {
      chart.line(predictedPath(prediction.now, prediction.paths[k]), kPredictionColour,
                 k == 0 ? 1.6 : 0.8, LineStyle::kDashed);
    }
    chart.dot(prediction.now, categoryColour(prediction.object), 4.0);
  }
  chart.legend("true paths, a colour each", paler(categoryColour(0)));
  chart.legend("predicted, 3 s", kPredictionColour, LineStyle::kDashed);
  chart.legend("camera", kCameraColour, LineStyle::kDotted);
  return chart.picture();
}

cv::Mat errorOverHorizonPlot(
    const std::vector<std::pair<std::string, PredictionError>>& predictors) {
  ChartFrame frame{"Mean error over the horizon", "horizon [s]", "error [m]", {0, 3}, {0, 0.1}};
  for (const auto& [name, error] : predictors) frame.y.include(error.mean_error_m.back());
  frame.height = 460;
  Chart chart(frame);
  std::size_t number = 0;
  for (const auto& [name, error] : predictors) {
    Points points = {{0.0, 0.0}};
    for (std::size_t j = 0; j < kHorizons; ++j) {
      points.emplace_back(kHorizonStep_s * static_cast<double>(j + 1), error.mean_error_m[j]);
    }
    const auto style = number < 8 ? LineStyle::kSolid : LineStyle::kDashed;
    chart.line(points, categoryColour(number), 2.2, style);
    chart.legend(name + ": ADE " + fixedText(error.ade_m, 3) + ", FDE " + fixedText(error.fde_m, 3),
                 categoryColour(number), style);
    ++number;
  }
  return chart.picture();
}

}  // namespace headway::eval
