// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/figures.h>
#include <headway/eval/prediction_error.h>
#include <headway/eval/track_error.h>
#include <headway/eval/trajectory_error.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>

namespace headway::eval {
namespace {

using plot::fixedText;
using plot::percentText;
using plot::TextTable;
using Json = nlohmann::ordered_json;

Json orNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json toJson(const TrackError& error) {
  Json json;
  json["rmse_m"] = orNull(error.rmse_m);
  json["precision"] = orNull(error.precision);
  json["recall"] = orNull(error.recall);
  json["f1"] = orNull(error.f1);
  json["mota"] = orNull(error.mota);
  json["motp"] = orNull(error.motp);
  json["idsw"] = error.idsw;
  json["frag"] = error.frag;
  json["hota"] = orNull(error.hota);
  json["deta"] = orNull(error.deta);
  json["assa"] = orNull(error.assa);
  json["samota"] = orNull(error.samota);
  json["amota"] = orNull(error.amota);
  json["truth_boxes"] = error.truth_boxes;
  json["tp"] = error.tp;
  json["fp"] = error.fp;
  json["fn"] = error.fn;
  json["score_threshold"] = orNull(error.score_threshold);
  return json;
}

Json toJson(const PredictionError& error) {
  const std::array<std::string, 3> seconds = {"_1s", "_2s", "_3s"};
  const std::array<std::string, 3> ellipses = {"coverage_50", "coverage_90", "coverage_95"};
  Json json;
  json["cases"] = error.cases;
  json["ade_m"] = orNull(error.ade_m);
  json["fde_m"] = orNull(error.fde_m);
  for (std::size_t s = 0; s < 3; ++s) json["miss_rate" + seconds[s]] = orNull(error.miss_rate[s]);
  json["best_of_k_ade_m"] = orNull(error.best_of_k_ade_m);
  for (std::size_t p = 0; p < 3; ++p) {
    for (std::size_t s = 0; s < 3; ++s) {
      json[ellipses[p] + seconds[s]] = orNull(error.coverage[p][s]);
    }
  }
  json["nees"] = orNull(error.nees);
  return json;
}

/// One JSON object per class and one for all classes.
template <typename Errors>
Json jsonByClass(const Errors& errors) {
  Json json;
  for (const auto& [object_class, error] : errors.classes) {
    json[std::string(toString(object_class))] = toJson(error);
  }
  json["all"] = toJson(errors.all);
  return json;
}

std::vector<std::string> rowOf(const std::string& name, const TrackError& error) {
  return {name,
          fixedText(error.rmse_m, 3),
          percentText(error.precision, 2),
          percentText(error.recall, 2),
          percentText(error.f1, 2),
          percentText(error.mota, 2),
          percentText(error.motp, 2),
          std::to_string(error.idsw),
          std::to_string(error.frag),
          percentText(error.hota, 2),
          percentText(error.deta, 2),
          percentText(error.assa, 2),
          percentText(error.samota, 2),
          percentText(error.amota, 2)};
}

std::vector<std::string> rowOf(const std::string& name, const PredictionError& error) {
  std::vector<std::string> row = {name, std::to_string(error.cases), fixedText(error.ade_m, 3),
                                  fixedText(error.fde_m, 3), fixedText(error.best_of_k_ade_m, 3)};
  for (const auto& rate : error.miss_rate) row.push_back(percentText(rate, 2));
  for (const auto& ratio : error.coverage[1]) row.push_back(percentText(ratio, 2));
  row.push_back(fixedText(error.nees, 2));
  return row;
}

/// Headings, one row per class, and one for all classes.
template <typename Errors>
TextTable tableByClass(std::vector<std::string> headings, const Errors& errors) {
  TextTable table = {std::move(headings)};
  for (const auto& [object_class, error] : errors.classes) {
    table.push_back(rowOf(std::string(toString(object_class)), error));
  }
  table.push_back(rowOf("all", errors.all));
  return table;
}

}  // namespace

Json toJson(const PredictionErrors& errors) { return jsonByClass(errors); }

Json toJson(const TrackErrors& errors) { return jsonByClass(errors); }

Json toJson(const TrajectoryError& error) {
  Json json;
  json["frames"] = error.frames;
  json["frames_matched"] = error.frames_matched;
  json["path_m"] = error.path_m;
  json["path_ratio"] = orNull(error.path_ratio);
  json["ate_rmse_m"] = error.ate_m.rmse;
  json["ate_mean_m"] = error.ate_m.mean;
  json["ate_sd_m"] = error.ate_m.sd;
  json["ate_median_m"] = error.ate_m.median;
  json["ate_max_m"] = error.ate_m.max;
  json["rpe_trans_rmse_m"] = error.rpe_trans_rmse_m;
  json["rpe_rot_rmse_deg"] = error.rpe_rot_rmse_deg;
  json["kitti_trans_percent"] = error.kitti ? Json(error.kitti->trans_percent) : Json(nullptr);
  json["kitti_rot_deg_per_m"] = error.kitti ? Json(error.kitti->rot_deg_per_m) : Json(nullptr);
  json["kitti_segments"] = error.kitti ? error.kitti->segments : 0;
  json["truth_poses"] = error.truth_poses;
  json["scale"] = error.scale;
  return json;
}

TextTable tableOf(const TrajectoryError& error) {
  const auto& ate = error.ate_m;
  TextTable table = {{"figure", "value", "unit"}};
  table.push_back({"frames matched",
                   std::to_string(error.frames_matched) + " of " + std::to_string(error.frames),
                   ""});
  table.push_back({"true path", fixedText(error.path_m, 2), "m"});
  table.push_back({"path ratio", fixedText(error.path_ratio, 4), ""});
  table.push_back({"ATE RMSE", fixedText(ate.rmse, 4), "m"});
  table.push_back({"ATE mean", fixedText(ate.mean, 4), "m"});
  table.push_back({"ATE standard deviation", fixedText(ate.sd, 4), "m"});
  table.push_back({"ATE median", fixedText(ate.median, 4), "m"});
  table.push_back({"ATE maximum", fixedText(ate.max, 4), "m"});
  table.push_back({"RPE translation RMSE, per frame", fixedText(error.rpe_trans_rmse_m, 4), "m"});
  table.push_back({"RPE rotation RMSE, per frame", fixedText(error.rpe_rot_rmse_deg, 4), "deg"});
  const auto& kitti = error.kitti;
  table.push_back({"KITTI translation", kitti ? fixedText(kitti->trans_percent, 3) : "—", "%"});
  table.push_back({"KITTI rotation", kitti ? fixedText(kitti->rot_deg_per_m, 5) : "—", "deg/m"});
  if (error.scale != 1.0) table.push_back({"scale", fixedText(error.scale, 5), ""});
  return table;
}

TextTable tableOf(const TrackErrors& errors) {
  return tableByClass({"class", "RMSE m", "prec %", "recall %", "F1 %", "MOTA %", "MOTP %", "IDSW",
                       "FRAG", "HOTA %", "DetA %", "AssA %", "sAMOTA %", "AMOTA %"},
                      errors);
}

TextTable positionTable(const TrackErrors& raw, const TrackErrors& tracks) {
  TextTable table = {{"class", "RMSE m", "precision %", "recall %", "F1 %"}};
  const auto add = [&table](const std::string& name, const TrackError& a, const TrackError& b) {
    table.push_back({name, fixedText(a.rmse_m, 3) + " / " + fixedText(b.rmse_m, 3),
                     percentText(a.precision, 2) + " / " + percentText(b.precision, 2),
                     percentText(a.recall, 2) + " / " + percentText(b.recall, 2),
                     percentText(a.f1, 2) + " / " + percentText(b.f1, 2)});
  };
  for (const auto& [object_class, error] : raw.classes) {
    add(std::string(toString(object_class)), error, tracks.classes.at(object_class));
  }
  add("all", raw.all, tracks.all);
  return table;
}

TextTable tableOf(const PredictionErrors& errors) {
  return tableByClass({"class", "cases", "ADE m", "FDE m", "best ADE m", "miss 1s %", "miss 2s %",
                       "miss 3s %", "in 90% 1s", "in 90% 2s", "in 90% 3s", "NEES"},
                      errors);
}

}  // namespace headway::eval
