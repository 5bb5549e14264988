#include "suite_report.h"

#include <headway/eval/bar_plot.h>
#include <headway/eval/chart.h>
#include <headway/eval/json.h>
#include <headway/objects/predictor.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <ostream>

namespace headway::app {
namespace {

using eval::fixedText;
using eval::TextTable;

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

std::string percentText(std::optional<double> share) {
  if (share) share = 100.0 * *share;
  return fixedText(share, 1);
}

void addPositions(std::vector<std::string>& row, const eval::TrackError& error) {
  row.push_back(fixedText(error.rmse_m, 3));
  row.push_back(percentText(error.precision));
  row.push_back(percentText(error.recall));
  row.push_back(percentText(error.f1));
}

double valueOrGap(std::optional<double> value) {
  return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

eval::BarPlot emptyBars(const std::string& title, const std::string& y_label,
                        const std::vector<SuiteEntry>& entries) {
  eval::BarPlot plot{title, y_label, {}, {}};
  for (const auto& entry : entries) plot.groups.push_back(entry.name);
  return plot;
}

cv::Mat cameraBars(const std::vector<SuiteEntry>& entries) {
  std::vector<SuiteEntry> with_images;
  for (const auto& entry : entries) {
    if (!entry.camera.empty()) with_images.push_back(entry);
  }
  auto plot =
      emptyBars("Camera position, RMSE by rejection of what moves", "ATE RMSE [m]", with_images);
  for (std::size_t i = 0; i < rejections().size(); ++i) {
    eval::BarSeries series{rejections()[i].name, {}};
    for (const auto& entry : with_images) {
      const bool known = i < entry.camera.size() && entry.camera[i].second.error.has_value();
      series.values.push_back(known ? entry.camera[i].second.error->ate_m.rmse
                                    : valueOrGap(std::nullopt));
    }
    plot.series.push_back(series);
  }
  return eval::barPlot(plot);
}

cv::Mat predictionBars(const std::vector<SuiteEntry>& entries) {
  auto plot = emptyBars("Predictions on our own tracks", "ADE [m]", entries);
  for (const auto& entry : entries) {
    const std::size_t predictors = entry.objects ? entry.objects->on_tracks.size() : 0;
    for (std::size_t i = 0; i < predictors; ++i) {
      const auto& [name, errors] = entry.objects->on_tracks[i];
      if (plot.series.size() <= i) plot.series.push_back({name, {}});
      plot.series[i].values.push_back(valueOrGap(errors.all.ade_m));
    }
  }
  return eval::barPlot(plot);
}

cv::Mat positionBars(const std::vector<SuiteEntry>& entries) {
  auto plot = emptyBars("Positions of objects", "RMSE [m]", entries);
  plot.series = {{"detector", {}}, {"ours", {}}};
  for (const auto& entry : entries) {
    const auto& o = entry.objects;
    plot.series[0].values.push_back(valueOrGap(o ? o->raw.all.rmse_m : std::nullopt));
    plot.series[1].values.push_back(valueOrGap(o ? o->tracks.all.rmse_m : std::nullopt));
  }
  return eval::barPlot(plot);
}

nlohmann::ordered_json predictorFigures(
    const std::vector<std::pair<std::string, eval::PredictionErrors>>& predictors) {
  nlohmann::ordered_json json;
  for (const auto& [name, errors] : predictors) json[name] = eval::toJson(errors);
  return json;
}

}  // namespace

ObjectErrors judgeObjects(const ObjectFigures& figures) {
  eval::TrackErrorParams positions;
  positions.positions_only = true;
  ObjectErrors errors{
      eval::trackErrors(figures.raw, positions), eval::trackErrors(figures.tracks, {}), {}, {}};
  for (const auto& [name, judge] : figures.on_tracks) {
    errors.on_tracks.emplace_back(name, judge.errors());
  }
  for (const auto& [name, judge] : figures.on_truth) {
    errors.on_truth.emplace_back(name, judge.errors());
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
    for (std::size_t i = 0; i < rejections().size(); ++i) {
      table.back().push_back(i < entry.camera.size() ? ateText(entry.camera[i].second) : "—");
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
                      "own tracks: ADE m", "FDE m", "in 90 % ellipse at 1 / 2 / 3 s"}};
  for (std::size_t i = 0; i < errors.on_truth.size(); ++i) {
    table.push_back({errors.on_truth[i].first});
    for (const auto* on : {&errors.on_truth[i].second.all, &errors.on_tracks.at(i).second.all}) {
      table.back().push_back(fixedText(on->ade_m, 3));
      table.back().push_back(fixedText(on->fde_m, 3));
      const auto& inside = on->coverage[1];
      table.back().push_back(percentText(inside[0]) + " / " + percentText(inside[1]) + " / " +
                             percentText(inside[2]));
    }
  }
  return table;
}

TextTable objectTable(const std::vector<SuiteEntry>& entries) {
  TextTable table = {{"recording", "raw RMSE m", "precision %", "recall %", "F1 %", "our RMSE m",
                      "precision %", "recall %", "F1 %"}};
  for (const auto& entry : entries) {
    table.push_back({entry.name});
    if (!entry.objects) continue;
    addPositions(table.back(), entry.objects->raw.all);
    addPositions(table.back(), entry.objects->tracks.all);
  }
  return table;
}

void writeSuite(std::ostream& out, const std::vector<SuiteEntry>& entries) {
  out << "Camera position by rejection of what moves: RMSE / mean / SD in m\n\n";
  eval::writeTable(out, cameraTable(entries));
  out << "\nPredictions on our own tracks: ADE / FDE in m over 3 s\n\n";
  eval::writeTable(out, predictionTable(entries, &ObjectErrors::on_tracks));
  out << "\nPredictions on exact histories: ADE / FDE in m over 3 s\n\n";
  eval::writeTable(out, predictionTable(entries, &ObjectErrors::on_truth));
  for (const auto& entry : entries) {
    if (!entry.is_group || !entry.objects || entry.objects->on_truth.empty()) continue;
    out << "\nPredictors, " << entry.name << "\n\n";
    eval::writeTable(out, predictorTable(*entry.objects));
  }
  out << "\nPositions of objects: the detector's and ours\n\n";
  eval::writeTable(out, objectTable(entries));
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
  return eval::stacked({cameraBars(shown), predictionBars(shown), positionBars(shown)});
}

}  // namespace headway::app
