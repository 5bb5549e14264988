// SPDX-License-Identifier: BSD-3-Clause
// Plots of errors.
#include <headway/core/object_class.h>
#include <headway/eval/grid_error.h>
#include <headway/eval/plots.h>
#include <headway/plot/chart.h>
#include <headway/plot/colours.h>
#include <headway/plot/text_table.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace headway::eval {
namespace {

/// A colour of cells and its meaning.
struct Shade {
  std::string name;
  cv::Vec3b bgr;
};

constexpr int kLegendRow_px = 26;

/// Cells seen from above, enlarged, with legend and scale bar.
///
/// @param cells   8-bit BGR, one pixel a cell, y upwards
/// @param side_m  of a cell [m]
cv::Mat cellPicture(const cv::Mat& cells, double side_m, const std::vector<Shade>& shades) {
  const int side = std::clamp(1600 / std::max(1, cells.cols), 1, 8);
  cv::Mat enlarged;
  cv::resize(cells, enlarged, {}, side, side, cv::INTER_NEAREST);
  const int legend_px = kLegendRow_px * (static_cast<int>(shades.size()) + 1) + 10;
  cv::Mat picture(enlarged.rows + legend_px, std::max(enlarged.cols, 900), CV_8UC3,
                  cv::Scalar(255, 255, 255));
  enlarged.copyTo(picture(cv::Rect(0, 0, enlarged.cols, enlarged.rows)));
  int y = enlarged.rows + 10;
  const auto write = [&](const std::string& text) {
    cv::putText(picture, text, {44, y + 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(30, 30, 30),
                1, cv::LINE_AA);
    y += kLegendRow_px;
  };
  for (const auto& shade : shades) {
    const cv::Rect box(14, y, 22, 20);
    cv::rectangle(picture, box, cv::Scalar(shade.bgr), cv::FILLED);
    cv::rectangle(picture, box, cv::Scalar(120, 120, 120), 1);
    write(shade.name);
  }
  const int ten_metres = static_cast<int>(10.0 / side_m * side);
  cv::line(picture, {14, y + 10}, {14 + ten_metres, y + 10}, cv::Scalar(30, 30, 30), 2);
  cv::putText(picture, "10 m", {24 + ten_metres, y + 16}, cv::FONT_HERSHEY_SIMPLEX, 0.5,
              cv::Scalar(30, 30, 30), 1, cv::LINE_AA);
  return picture;
}

constexpr double kCell_m = 0.2;

/// What lies in the column above a cell.
struct Column {
  std::size_t covered = 0;
  std::size_t surface = 0;
  bool has_mover = false;
};

const std::vector<Shade>& coverageShades() {
  static const std::vector<Shade> kShades = {
      {"at least 80 % of the surface covered", {110, 150, 60}},
      {"50 to 80 %", {130, 215, 190}},
      {"20 to 50 %", {110, 190, 250}},
      {"less", {40, 90, 230}},
      {"points where only moving objects were", {200, 0, 200}},
      {"no surface within reach", {238, 238, 238}}};
  return kShades;
}

cv::Vec3b shadeOf(const Column& column) {
  if (column.has_mover) return coverageShades()[4].bgr;
  if (column.surface == 0) return coverageShades()[5].bgr;
  const double ratio = static_cast<double>(column.covered) / static_cast<double>(column.surface);
  const std::array<double, 3> limits = {0.8, 0.5, 0.2};
  std::size_t shade = 0;
  while (shade < limits.size() && ratio < limits[shade]) ++shade;
  return coverageShades()[shade].bgr;
}

/// Cells around all surface within reach; their states are not used.
GridCells cellsAround(const std::vector<TrueSurface::Patch>& patches, const DenseError& error) {
  Eigen::AlignedBox2d area(Eigen::Vector2d::Zero());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (error.is_covered[i] != 2) area.extend(Eigen::Vector2d(patches[i].centre.head<2>()));
  }
  const Eigen::Vector2d corner = area.min().array() - 1.0;
  const Eigen::Vector2d size = (area.max() - corner).array() + 1.0;
  return {corner, kCell_m, static_cast<int>(size.x() / kCell_m) + 1,
          static_cast<int>(size.y() / kCell_m) + 1};
}

}  // namespace

cv::Mat densePlot(const std::vector<TrueSurface::Patch>& patches,
                  const std::vector<Eigen::Vector3d>& points, const DenseError& error) {
  const GridCells grid = cellsAround(patches, error);
  std::vector<Column> columns(grid.states.size());
  for (std::size_t i = 0; i < patches.size(); ++i) {
    if (error.is_covered[i] == 2) continue;
    const auto cell = grid.at(patches[i].centre.head<2>());
    if (!cell) continue;
    ++columns[*cell].surface;
    columns[*cell].covered += error.is_covered[i];
  }
  for (const auto point : error.mover_points) {
    if (const auto cell = grid.at(points[point].head<2>())) columns[*cell].has_mover = true;
  }
  cv::Mat cells(grid.rows, grid.columns, CV_8UC3);
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      cells.at<cv::Vec3b>(grid.rows - 1 - row, column) =
          shadeOf(columns[static_cast<std::size_t>(row * grid.columns + column)]);
    }
  }
  return cellPicture(cells, grid.resolution_m, coverageShades());
}

namespace {

const std::vector<Shade>& shades() {
  static const std::vector<Shade> kShades = {
      {"free, correct", {246, 246, 246}},
      {"occupied, correct", {40, 40, 40}},
      {"occupied, truly free", {60, 120, 255}},
      {"occupied, truly free, on a moving object's path", {200, 0, 200}},
      {"free, truly occupied", {220, 120, 20}},
      {"observed, truth unknown", {214, 204, 190}},
      {"not observed", {176, 176, 176}}};
  return kShades;
}

cv::Vec3b shadeOf(CellState truth, CellState estimate, bool swept) {
  if (estimate == CellState::kUnknown) return shades()[6].bgr;
  if (truth == CellState::kUnknown) return shades()[5].bgr;
  if (truth == estimate) return shades()[truth == CellState::kFree ? 0 : 1].bgr;
  if (truth == CellState::kOccupied) return shades()[4].bgr;
  return shades()[swept ? 3 : 2].bgr;
}

}  // namespace

cv::Mat gridPlot(const GridCells& truth, const GridCells& estimate,
                 const std::vector<std::uint8_t>& swept) {
  cv::Mat cells(truth.rows, truth.columns, CV_8UC3);
  for (int row = 0; row < truth.rows; ++row) {
    for (int column = 0; column < truth.columns; ++column) {
      const auto i = static_cast<std::size_t>(row * truth.columns + column);
      cells.at<cv::Vec3b>(truth.rows - 1 - row, column) =
          shadeOf(truth.states[i], estimate.states[i], swept[i] != 0);
    }
  }
  return cellPicture(cells, truth.resolution_m, shades());
}

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

namespace {

Points over(const std::vector<RecallPoint>& curve, double RecallPoint::*figure) {
  Points points;
  for (const auto& point : curve) points.emplace_back(100.0 * point.recall, 100.0 * point.*figure);
  return points;
}

constexpr Colour kTrackTruthColour{170, 205, 235};
constexpr Colour kRawColour{150, 150, 150};
constexpr Colour kTrackCameraColour{110, 110, 110};

Points seenFromAbove(const TrueObject& object) {
  Points points;
  for (const auto& point : object.path) points.emplace_back(point.position.head<2>());
  return points;
}

/// The path, split at gaps of more than five frames.
std::vector<Points> segments(const TrueObject& object) {
  std::vector<Points> result(1);
  for (std::size_t i = 0; i < object.path.size(); ++i) {
    const bool gap = i > 0 && object.path[i].frame - object.path[i - 1].frame > 5;
    if (gap) result.emplace_back();
    result.back().emplace_back(object.path[i].position.head<2>());
  }
  return result;
}

}  // namespace

cv::Mat trackMapPlot(const TrackMap& map) {
  Points all = map.camera_path;
  for (const auto* objects : {&map.truth, &map.tracks}) {
    for (const auto& object : *objects) {
      for (const auto& point : seenFromAbove(object)) all.push_back(point);
    }
  }
  plot::Chart chart(
      {map.title, "x [m]", "y [m]", plot::rangeOf(all, 0), plot::rangeOf(all, 1), true});
  for (const auto& object : map.truth) {
    for (const auto& segment : segments(object)) chart.line(segment, kTrackTruthColour, 6.0);
    chart.dot(object.path.front().position.head<2>(), kTrackTruthColour, 4.0);
  }
  for (const auto& object : map.raw) {
    for (const auto& point : seenFromAbove(object)) chart.dot(point, kRawColour, 1.2);
  }
  for (std::size_t i = 0; i < map.tracks.size(); ++i) {
    for (const auto& segment : segments(map.tracks[i]))
      chart.line(segment, plot::categoryColour(i), 1.6);
  }
  chart.line(map.camera_path, kTrackCameraColour, 1.6, plot::LineStyle::kDotted);
  chart.legend("truth", kTrackTruthColour);
  if (!map.raw.empty()) chart.legend("detector", kRawColour, plot::LineStyle::kDotted);
  chart.legend("tracks, one colour each", plot::categoryColour(0));
  chart.legend("camera", kTrackCameraColour, plot::LineStyle::kDotted);
  return chart.picture();
}

cv::Mat trackPlot(const std::string& title, const TrackErrors& errors) {
  plot::ChartFrame frame{title, "recall [%]", "MOTA, sMOTA [%]", {0, 100}, {0, 100}};
  for (const auto& [object_class, error] : errors.classes) {
    for (const auto& point : error.curve) frame.y.include(std::max(-100.0, 100.0 * point.mota));
  }
  plot::Chart chart(frame);
  std::size_t number = 0;
  for (const auto& [object_class, error] : errors.classes) {
    const Colour colour = plot::categoryColour(number++);
    const std::string name(displayName(object_class));
    const auto percent = [](std::optional<double> ratio) { return plot::percentText(ratio, 1); };
    chart.line(over(error.curve, &RecallPoint::smota), colour, 2.4);
    chart.line(over(error.curve, &RecallPoint::mota), colour, 2.0, plot::LineStyle::kDashed);
    chart.legend(name + " sMOTA (sAMOTA " + percent(error.samota) + ")", colour);
    chart.legend(name + " MOTA (best " + percent(error.mota) + ")", colour,
                 plot::LineStyle::kDashed);
  }
  return chart.picture();
}

namespace {

constexpr Colour kCameraColour{150, 150, 150};
constexpr Colour kPredictionColour{20, 20, 20};

Points predictedPath(const Eigen::Vector2d& now, const PredictedPath& path) {
  Points points = {now};
  for (const auto& point : path.points) points.emplace_back(point.position.head<2>());
  return points;
}

void append(Points& all, const Points& more) { all.insert(all.end(), more.begin(), more.end()); }

void drawTruth(plot::Chart& chart, const TrueObject& object, Colour colour) {
  const auto points = seenFromAbove(object);
  const double extent = std::max(plot::rangeOf(points, 0).size(), plot::rangeOf(points, 1).size());
  if (extent < 1.0) {  // [m]: it hardly moves
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
  for (const auto& object : objects) append(all, seenFromAbove(object));
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

cv::Mat peoplePlot(const PeopleError& error) {
  plot::BarChart bars{"People found", "found [%]", {}, {{"walking", {}}, {"standing", {}}}};
  std::map<std::string, PersonFrames> all = error.walking;
  all.insert(error.standing.begin(), error.standing.end());
  for (const auto& [name, cell] : all) {
    bars.groups.push_back(name + " m");
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& cells = i == 0 ? error.walking : error.standing;
      const auto found = cells.find(name);
      const auto ratio = found == cells.end() ? std::nullopt : found->second.foundRatio();
      bars.series[i].values.push_back(100.0 * ratio.value_or(0.0));
    }
  }
  return plot::drawBars(bars);
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
