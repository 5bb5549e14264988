// SPDX-License-Identifier: BSD-3-Clause
// Object tracking on the recordings of the suite, and the tables of all errors.
#include "suite_report.h"

#include <headway/core/text.h>
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/prediction_error.h>
#include <headway/eval/prediction_evaluation.h>
#include <headway/objects/predictor.h>
#include <headway/pipeline/moving_regions.h>
#include <headway/plot/chart.h>
#include <headway/plot/text_table.h>

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>

namespace headway::app {
namespace {

constexpr double kMaxGap_s = 0.25;  // of a true path to interpolate over

/// Tracks and predictions of one recording.
struct TrackingRun {
  std::vector<eval::LabelledFrame> tracks;  ///< estimates only, optical frame
  std::vector<eval::TrackPrediction> predictions;
};

eval::LabelledBox boxOf(const Track& track, const Pose& T_cam_map,
                        const std::optional<StereoCamera>& camera) {
  eval::LabelledBox box;
  box.id = track.id.value;
  box.object_class = track.object_class;
  box.score = track.score;
  box.box3d = opticalBox(track.position, track.size, track.yaw, T_cam_map);
  box.box2d = track.box2d;
  if (!box.box2d && camera) box.box2d = pipeline::projectedBox(*box.box3d, *camera);
  return box;
}

TrackingRun runTracking(const ObjectRecording& recording, const objects::ObjectsParams& params) {
  pipeline::PerceptionParams perception_params;
  perception_params.objects = params;
  pipeline::Perception perception(nullptr, perception_params);
  TrackingRun run;
  std::map<std::int64_t, double> scores;
  for (const auto& frame : recording.frames) {
    const auto update = perception.process(frame);
    if (run.tracks.size() <= frame.index) run.tracks.resize(frame.index + 1);
    const Pose T_cam_map = (update.camera.T_map_robot * recording.T_robot_cam).inverse();
    for (const auto& track : update.objects.tracks) {
      if (!isShown(track)) continue;
      run.tracks[frame.index].estimates.push_back(boxOf(track, T_cam_map, recording.camera));
      scores[track.id.value] = track.score;
      if (track.predictions.empty()) continue;
      run.predictions.push_back(
          {frame.index, frame.time, track.id, track.object_class, track.predictions});
    }
  }
  for (auto& frame : run.tracks) {  // one score per track, as in tracks_kitti.txt
    for (auto& box : frame.estimates) box.score = scores.at(box.id);
  }
  return run;
}

/// Combines the recording's labels with estimates.
eval::LabelledSequence withLabels(const ObjectRecording& recording,
                                  std::vector<eval::LabelledFrame> frames) {
  frames.resize(std::max(frames.size(), recording.labels.size()));
  for (std::size_t k = 0; k < recording.labels.size(); ++k) {
    frames[k].truth = recording.labels[k].truth;
    frames[k].dont_care = recording.labels[k].dont_care;
  }
  return {recording.name, std::move(frames)};
}

std::vector<eval::LabelledFrame> rawBoxes(const ObjectRecording& recording) {
  std::vector<eval::LabelledFrame> frames;
  std::int64_t next_id = -1;
  for (const auto& frame : recording.frames) {
    if (frames.size() <= frame.index) frames.resize(frame.index + 1);
    if (!frame.detections) continue;
    for (const auto& detection : frame.detections->items) {
      eval::LabelledBox box;
      box.id = next_id--;
      box.object_class = detection.object_class;
      box.score = detection.score;
      box.box2d = detection.box2d;
      box.box3d = detection.box3d;
      frames[frame.index].estimates.push_back(box);
    }
  }
  return frames;
}

/// Camera pose at each frame index; frames without a pose repeat the previous one.
std::vector<Stamped<Pose>> cameraPoses(const ObjectRecording& recording) {
  std::vector<Stamped<Pose>> poses;
  for (const auto& frame : recording.frames) {
    if (!frame.T_map_robot) continue;
    while (poses.size() < frame.index) {
      const auto previous =
          poses.empty() ? Stamped<Pose>{frame.time, *frame.T_map_robot} : poses.back();
      poses.push_back({previous.time + eval::kNominalFrameInterval_s, previous.value});
    }
    poses.push_back({frame.time, *frame.T_map_robot * recording.T_robot_cam});
  }
  while (!poses.empty() && poses.size() < recording.labels.size()) {
    poses.push_back({poses.back().time + eval::kNominalFrameInterval_s, poses.back().value});
  }
  return poses;
}

eval::PredictionEvaluator evaluateOnTracks(const std::vector<eval::TrueObject>& truth,
                                           const TrackingRun& run) {
  eval::PredictionEvaluator evaluator;
  for (const auto& item :
       eval::trackCases(truth, run.predictions, eval::kMatchDistance_m, kMaxGap_s).cases) {
    const auto& prediction = run.predictions[item.prediction];
    evaluator.add(prediction.object_class, prediction.paths, item.future);
  }
  return evaluator;
}

}  // namespace

ObjectFigures runTracks(const ObjectRecording& recording, const objects::ObjectsParams& params) {
  ObjectFigures figures;
  figures.raw = {withLabels(recording, rawBoxes(recording))};
  figures.tracks = {withLabels(recording, runTracking(recording, params).tracks)};
  return figures;
}

ObjectFigures runObjects(const ObjectRecording& recording, const objects::ObjectsParams& params) {
  ObjectFigures figures = runTracks(recording, params);
  eval::PredictionSequence truth;
  truth.name = recording.name;
  truth.T_map_cam = cameraPoses(recording);
  truth.objects = eval::trueObjects(recording.labels, truth.T_map_cam);
  for (const auto& name : objects::predictorNames()) {
    auto with_predictor = params;
    with_predictor.predictor = objects::predictorKindFrom(name);
    figures.on_tracks.emplace_back(
        name, evaluateOnTracks(truth.objects, runTracking(recording, with_predictor)));
    figures.on_truth.emplace_back(
        name, eval::evaluatePredictor({truth}, name, params.prediction).evaluator);
  }
  return figures;
}

void add(const ObjectFigures& other, ObjectFigures& together) {
  together.raw.insert(together.raw.end(), other.raw.begin(), other.raw.end());
  together.tracks.insert(together.tracks.end(), other.tracks.begin(), other.tracks.end());
  const auto add_evaluators = [](const PredictorEvaluators& from, PredictorEvaluators& to) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (to.size() <= i) to.push_back({from[i].first, {}});
      to[i].second.add(from[i].second);
    }
  };
  add_evaluators(other.on_tracks, together.on_tracks);
  add_evaluators(other.on_truth, together.on_truth);
}

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

nlohmann::ordered_json predictorFigures(const PredictorErrors& predictors) {
  nlohmann::ordered_json json;
  for (const auto& [name, errors] : predictors) json[name] = eval::toJson(errors);
  return json;
}

/// The paper's Table I: RMSE / mean / SD of the camera's position.
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

/// The paper's Table II: ADE / FDE, a column for each predictor.
///
/// @param figures  on_tracks or on_truth
TextTable predictionTable(const std::vector<SuiteEntry>& entries,
                          PredictorErrors ObjectErrors::*figures) {
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

/// All predictors on one set of recordings: errors and the ratio inside the 90 % ellipse, on exact
/// histories and on headway's tracks.
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

/// The paper's Table III: positions of raw detections and of tracks.
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

void writeSuite(std::ostream& out, const std::vector<SuiteEntry>& entries) {
  out << "Camera position by rejection of moving objects: RMSE / mean / SD in m\n\n";
  plot::writeTable(out, cameraTable(entries));
  out << "\nPredictions on headway's tracks: ADE / FDE in m over 3 s\n\n";
  plot::writeTable(out, predictionTable(entries, &ObjectErrors::on_tracks));
  out << "\nPredictions on exact histories: ADE / FDE in m over 3 s\n\n";
  plot::writeTable(out, predictionTable(entries, &ObjectErrors::on_truth));
  for (const auto& entry : entries) {
    if (!entry.is_group || !entry.objects || entry.objects->on_truth.empty()) continue;
    out << "\nPredictors, " << printable(entry.name) << "\n\n";
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
