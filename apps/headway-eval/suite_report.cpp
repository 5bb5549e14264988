// SPDX-License-Identifier: BSD-3-Clause
#include "suite_report.h"

#include <headway/eval/figures.h>
#include <headway/objects/predictor.h>
#include <headway/plot/chart.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>

namespace headway::app {
namespace {

using plot::fixedText;
using plot::TextTable;

std::string framesText(const CameraFigures& figures) {
  const auto text = std::to_string(figures.frames);
  if (figures.frames >= figures.wanted) return text;
  return text + " of " + std::to_string(figures.wanted);
}

std::string ateText(const CameraFigures& figures) {
  if (!figures.error) return "lost";
  const auto& ate = figures.error->ate_m;
  auto text =
      fixedText(ate.rmse, 3) + " / " + fixedText(ate.mean, 3) + " / " + fixedText(ate.sd, 3);
  if (figures.lost > 0) text += " (" + std::to_string(figures.lost) + " lost)";
  return text;
}

/// Figures of one kind of rejection; null if the recording was not replayed with it.
const CameraFigures* figuresOf(const SuiteEntry& entry, const std::string& rejection) {
  const auto found = std::find_if(entry.camera.begin(), entry.camera.end(),
                                  [&](const auto& figures) { return figures.first == rejection; });
  return found == entry.camera.end() ? nullptr : &found->second;
}

std::string percent(std::optional<double> ratio) { return plot::percentText(ratio, 1); }

void addPositions(std::vector<std::string>& row, const eval::TrackError& error) {
  row.push_back(fixedText(error.rmse_m, 3));
  row.push_back(percent(error.precision));
  row.push_back(percent(error.recall));
  row.push_back(percent(error.f1));
}

double valueOrNan(std::optional<double> value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

plot::BarChart barChart(const std::string& title, const std::string& y_label,
                        const std::vector<SuiteEntry>& entries) {
  plot::BarChart chart{title, y_label, {}, {}};
  for (const auto& entry : entries) chart.groups.push_back(entry.name);
  return chart;
}

cv::Mat cameraPlot(const std::vector<SuiteEntry>& entries) {
  std::vector<SuiteEntry> with_images;
  for (const auto& entry : entries) {
    if (!entry.camera.empty()) with_images.push_back(entry);
  }
  auto chart =
      barChart("Camera position, RMSE by rejection of moving objects", "ATE RMSE [m]", with_images);
  for (const auto& rejection : rejections()) {
    plot::BarSeries series{rejection.name, {}};
    for (const auto& entry : with_images) {
      const auto* figures = figuresOf(entry, rejection.name);
      series.values.push_back(figures != nullptr && figures->error ? figures->error->ate_m.rmse
                                                                   : valueOrNan(std::nullopt));
    }
    chart.series.push_back(series);
  }
  return plot::drawBars(chart);
}

cv::Mat predictionPlot(const std::vector<SuiteEntry>& entries) {
  auto chart = barChart("Predictions on headway's tracks", "ADE [m]", entries);
  for (const auto& entry : entries) {
    const std::size_t predictors = entry.objects ? entry.objects->on_tracks.size() : 0;
    for (std::size_t i = 0; i < predictors; ++i) {
      const auto& [name, errors] = entry.objects->on_tracks[i];
      if (chart.series.size() <= i) chart.series.push_back({name, {}});
      chart.series[i].values.push_back(valueOrNan(errors.all.ade_m));
    }
  }
  return plot::drawBars(chart);
}

cv::Mat positionPlot(const std::vector<SuiteEntry>& entries) {
  auto chart = barChart("Positions of objects", "RMSE [m]", entries);
  chart.series = {{"detector", {}}, {"headway", {}}};
  for (const auto& entry : entries) {
    const auto& o = entry.objects;
    chart.series[0].values.push_back(valueOrNan(o ? o->raw.all.rmse_m : std::nullopt));
    chart.series[1].values.push_back(valueOrNan(o ? o->tracks.all.rmse_m : std::nullopt));
  }
  return plot::drawBars(chart);
}

nlohmann::ordered_json predictorFigures(
    const std::vector<std::pair<std::string, eval::PredictionErrors>>& predictors) {
  nlohmann::ordered_json json;
  for (const auto& [name, errors] : predictors) json[name] = eval::toJson(errors);
  return json;
}

}  // namespace

ObjectErrors evaluateObjects(const ObjectFigures& figures) {
  eval::TrackErrorParams positions;
  positions.positions_only = true;
  ObjectErrors errors{
      eval::trackErrors(figures.raw, positions), eval::trackErrors(figures.tracks, {}), {}, {}};
  for (const auto& [name, evaluator] : figures.on_tracks) {
    errors.on_tracks.emplace_back(name, evaluator.errors());
  }
  for (const auto& [name, evaluator] : figures.on_truth) {
    errors.on_truth.emplace_back(name, evaluator.errors());
  }
  return errors;
}

const std::vector<Rejection>& rejections() {
  static const std::vector<Rejection> kRejections = {
      {"none", slam::DynamicRejection::kNone},
      {"boxes", slam::DynamicRejection::kBoxes},
      {"geometric", slam::DynamicRejection::kGeometric},
      {"both", slam::DynamicRejection::kBoth}};
  return kRejections;
}

TextTable cameraTable(const std::vector<SuiteEntry>& entries) {
  TextTable table = {{"world", "frames"}};
  for (const auto& rejection : rejections()) table.front().push_back(rejection.name);
  for (const auto& entry : entries) {
    if (entry.camera.empty()) continue;
    table.push_back({entry.name, framesText(entry.camera.front().second)});
    for (const auto& rejection : rejections()) {
      const auto* figures = figuresOf(entry, rejection.name);
      table.back().push_back(figures != nullptr ? ateText(*figures) : "—");
    }
  }
  return table;
}

TextTable predictionTable(
    const std::vector<SuiteEntry>& entries,
    std::vector<std::pair<std::string, eval::PredictionErrors>> ObjectErrors::*figures) {
  TextTable table = {{"recording", "cases"}};
  for (const auto& name : objects::predictorNames()) table.front().push_back(name);
  for (const auto& entry : entries) {
    if (!entry.objects) {
      table.push_back({entry.name, "—"});
      continue;
    }
    const auto& predictors = (*entry.objects).*figures;
    if (predictors.empty()) continue;
    table.push_back({entry.name, std::to_string(predictors.front().second.all.cases)});
    for (const auto& [name, errors] : predictors) {
      table.back().push_back(fixedText(errors.all.ade_m, 3) + " / " +
                             fixedText(errors.all.fde_m, 3));
    }
  }
  return table;
}

TextTable predictorTable(const ObjectErrors& errors) {
  TextTable table = {{"predictor", "exact: ADE m", "FDE m", "in 90 % ellipse at 1 / 2 / 3 s",
                      "tracks: ADE m", "FDE m", "in 90 % ellipse at 1 / 2 / 3 s"}};
  for (std::size_t i = 0; i < errors.on_truth.size(); ++i) {
    table.push_back({errors.on_truth[i].first});
    for (const auto* on : {&errors.on_truth[i].second.all, &errors.on_tracks.at(i).second.all}) {
      table.back().push_back(fixedText(on->ade_m, 3));
      table.back().push_back(fixedText(on->fde_m, 3));
      const auto& inside = on->coverage[1];
      table.back().push_back(percent(inside[0]) + " / " + percent(inside[1]) + " / " +
                             percent(inside[2]));
    }
  }
  return table;
}

TextTable objectTable(const std::vector<SuiteEntry>& entries) {
  TextTable table = {{"recording", "raw RMSE m", "precision %", "recall %", "F1 %",
                      "headway RMSE m", "precision %", "recall %", "F1 %"}};
  for (const auto& entry : entries) {
    table.push_back({entry.name});
    if (!entry.objects) continue;
    addPositions(table.back(), entry.objects->raw.all);
    addPositions(table.back(), entry.objects->tracks.all);
  }
  return table;
}

void writeSuite(std::ostream& out, const std::vector<SuiteEntry>& entries) {
  out << "Camera position by rejection of moving objects: RMSE / mean / SD in m\n\n";
  plot::writeTable(out, cameraTable(entries));
  out << "\nPredictions on headway's tracks: ADE / FDE in m over 3 s\n\n";
  plot::writeTable(out, predictionTable(entries, &ObjectErrors::on_tracks));
  out << "\nPredictions on exact histories: ADE / FDE in m over 3 s\n\n";
  plot::writeTable(out, predictionTable(entries, &ObjectErrors::on_truth));
  for (const auto& entry : entries) {
    if (!entry.is_group || !entry.objects || entry.objects->on_truth.empty()) continue;
    out << "\nPredictors, " << entry.name << "\n\n";
    plot::writeTable(out, predictorTable(*entry.objects));
  }
  out << "\nPositions of objects: detections and headway's tracks\n\n";
  plot::writeTable(out, objectTable(entries));
}

nlohmann::ordered_json suiteFigures(const std::vector<SuiteEntry>& entries) {
  nlohmann::ordered_json json;
  for (const auto& entry : entries) {
    auto& part = json[entry.name];
    for (const auto& [name, figures] : entry.camera) {
      auto& camera = part["camera"][name];
      if (figures.error) camera = eval::toJson(*figures.error);
      camera["frames_lost"] = figures.lost;
    }
    if (!entry.objects) continue;
    part["predictions_on_tracks"] = predictorFigures(entry.objects->on_tracks);
    part["predictions_on_truth"] = predictorFigures(entry.objects->on_truth);
    part["objects"]["raw"] = eval::toJson(entry.objects->raw);
    part["objects"]["ours"] = eval::toJson(entry.objects->tracks);
  }
  return json;
}

cv::Mat suitePlot(const std::vector<SuiteEntry>& entries) {
  std::vector<SuiteEntry> shown;
  for (const auto& entry : entries) {
    if (entry.in_plot) shown.push_back(entry);
  }
  return plot::stacked({cameraPlot(shown), predictionPlot(shown), positionPlot(shown)});
}

}  // namespace headway::app
