// SPDX-License-Identifier: BSD-3-Clause
// Errors as JSON and as tables.
#include <headway/core/text.h>
#include <headway/eval/figures.h>
#include <headway/eval/moving_object_error.h>
#include <headway/eval/prediction_error.h>
#include <headway/eval/track_error.h>
#include <headway/eval/trajectory_error.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

namespace headway::eval {

using plot::fixedText;
using plot::percentText;
using plot::TextTable;
using Json = nlohmann::ordered_json;

std::optional<double> ratioOf(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

Json orNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

namespace {

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

namespace {

/// Yaw, pitch, roll [deg], as MRPT states poses.
Eigen::Vector3d anglesOf(const Eigen::Matrix3d& R) {
  return Eigen::Vector3d(std::atan2(R(1, 0), R(0, 0)),
                         std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0))),
                         std::atan2(R(2, 1), R(2, 2))) /
         kDegree;
}

const char* toString(BodyRotation::Source source) {
  switch (source) {
    case BodyRotation::Source::kAssumed:
      return "assumed";
    case BodyRotation::Source::kStated:
      return "stated";
    case BodyRotation::Source::kFound:
      return "found";
    case BodyRotation::Source::kUnknown:
      break;
  }
  return "unknown";
}

std::string textOf(const BodyRotation& body) {
  if (body.source == BodyRotation::Source::kUnknown) return "unknown";
  const Eigen::Vector3d angles = anglesOf(body.R_robot_truth);
  std::string text;
  for (const double angle : angles) {
    const double rounded = std::round(10.0 * angle) / 10.0 + 0.0;  // of -0.0 too
    text += (text.empty() ? "" : ",") + fixedText(rounded, 1);
  }
  if (body.source == BodyRotation::Source::kFound) {
    text += formatted(" +- %.1f (found)", body.sigma_rad / kDegree);
  }
  return text;
}

}  // namespace

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
  const Eigen::Vector3d angles = anglesOf(error.body.R_robot_truth);
  json["truth_rotation"] = toString(error.body.source);
  json["truth_rotation_deg"] = {angles[0], angles[1], angles[2]};
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
  if (error.body.source != BodyRotation::Source::kAssumed) {
    table.push_back({"truth's body on the robot: yaw,pitch,roll", textOf(error.body), "deg"});
  }
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

namespace {

Json countsJson(const MovingCounts& counts) {
  Json json;
  json["recall"] = orNull(counts.recall());
  json["recall_as_class"] = orNull(counts.recallAsClass());
  json["precision"] = orNull(counts.precision());
  json["precision_as_class"] = orNull(counts.precisionAsClass());
  json["labels"] = counts.labels;
  json["found"] = counts.found;
  json["found_as_class"] = counts.found_as_class;
  json["rows"] = counts.rows;
  json["right"] = counts.right;
  json["right_as_class"] = counts.right_as_class;
  return json;
}

Json groupsJson(const std::map<std::string, MovingCounts>& groups) {
  auto json = Json::object();
  for (const auto& [name, counts] : groups) json[name] = countsJson(counts);
  return json;
}

Json tracksJson(const std::vector<MovingTrack>& tracks) {
  auto json = Json::array();
  for (const auto& track : tracks) {
    json.push_back({{"id", track.id},
                    {"class", std::string(toString(track.object_class))},
                    {"first_frame", track.first_frame},
                    {"last_frame", track.last_frame},
                    {"rows", track.rows},
                    {"wrong", track.wrong},
                    {"false", track.isFalse()}});
  }
  return json;
}

void addRow(TextTable& table, const std::string& name, const MovingCounts& counts) {
  table.push_back({name, percentText(counts.recall(), 1), percentText(counts.recallAsClass(), 1),
                   std::to_string(counts.labels), percentText(counts.precision(), 1),
                   percentText(counts.precisionAsClass(), 1), std::to_string(counts.rows)});
}

void addMotion(TextTable& table, const std::string& name, std::size_t frames,
               const std::array<std::optional<double>, 4>& figures) {
  table.push_back({name, std::to_string(frames), fixedText(figures[0], 3), fixedText(figures[1], 3),
                   fixedText(figures[2], 2), fixedText(figures[3], 2)});
}

}  // namespace

Json toJson(const MovingObjectError& error) {
  Json json;
  json["frames"] = error.frames;
  json["all"] = countsJson(error.all);
  json["within_40m"] = countsJson(error.within_40m);
  json["classes"] = groupsJson(error.classes);
  json["ranges_m"] = groupsJson(error.ranges);
  json["occlusion"] = groupsJson(error.occlusion);
  json["moving_tracks"] = error.tracks.size();
  json["false_tracks"] = error.false_tracks;
  json["false_tracks_per_100_frames"] = orNull(error.falseTracksPer100Frames());
  json["duplicate_rows"] = error.duplicate_rows;
  json["rows_ignored"] = error.ignored;
  json["tracks"] = tracksJson(error.tracks);
  return json;
}

Json toJson(const LabelledObjectError& error) {
  const auto counts = [](const LabelledObjectCounts& c) {
    return Json{{"recall", orNull(c.recall())},
                {"class_ratio", orNull(c.classRatio())},
                {"labels", c.labels},
                {"found", c.found},
                {"found_as_class", c.found_as_class}};
  };
  Json json;
  json["max_range_m"] = error.max_range_m;
  json["max_occlusion"] = error.max_occlusion;
  json["all"] = counts(error.all);
  json["classes"] = Json::object();
  for (const auto& [name, of_class] : error.classes) json["classes"][name] = counts(of_class);
  return json;
}

Json toJson(const ObjectMotionErrors& errors) {
  Json json;
  json["translation_rmse_m"] = orNull(errors.translation_rmse_m);
  json["translation_mean_m"] = orNull(errors.translation_mean_m);
  json["rotation_rmse_deg"] = orNull(errors.rotation_rmse_deg);
  json["rotation_mean_deg"] = orNull(errors.rotation_mean_deg);
  json["frames"] = errors.frames;
  json["objects"] = Json::array();
  for (const auto& object : errors.objects) {
    json["objects"].push_back({{"id", object.id},
                               {"class", std::string(toString(object.object_class))},
                               {"frames", object.frames},
                               {"translation_rmse_m", object.translation_rmse_m},
                               {"translation_mean_m", object.translation_mean_m},
                               {"rotation_rmse_deg", object.rotation_rmse_deg},
                               {"rotation_mean_deg", object.rotation_mean_deg}});
  }
  return json;
}

TextTable tableOf(const MovingObjectError& error) {
  TextTable table = {
      {"moving objects", "recall %", "as class %", "labels", "precision %", "as class %", "rows"}};
  addRow(table, "all", error.all);
  addRow(table, "within 40 m", error.within_40m);
  for (const auto& [name, counts] : error.classes) addRow(table, name, counts);
  for (const auto& [name, counts] : error.ranges) addRow(table, name + " m", counts);
  for (const auto& [name, counts] : error.occlusion) addRow(table, "occlusion " + name, counts);
  return table;
}

TextTable tableOf(const LabelledObjectError& error) {
  TextTable table = {{"labels to " + fixedText(error.max_range_m, 0) + " m, occlusion to " +
                          std::to_string(error.max_occlusion),
                      "recall %", "labels", "found", "class right %", "as class"}};
  const auto add = [&](const std::string& name, const LabelledObjectCounts& counts) {
    table.push_back({name, percentText(counts.recall(), 1), std::to_string(counts.labels),
                     std::to_string(counts.found), percentText(counts.classRatio(), 1),
                     std::to_string(counts.found_as_class)});
  };
  add("all", error.all);
  for (const auto& [name, counts] : error.classes) add(name, counts);
  return table;
}

TextTable tableOf(const ObjectMotionErrors& errors) {
  TextTable table = {{"motion per frame", "frames", "RMSE m", "mean m", "RMSE deg", "mean deg"}};
  for (const auto& object : errors.objects) {
    addMotion(table, std::string(toString(object.object_class)) + " " + std::to_string(object.id),
              object.frames,
              {object.translation_rmse_m, object.translation_mean_m, object.rotation_rmse_deg,
               object.rotation_mean_deg});
  }
  addMotion(table, "mean of objects", errors.frames,
            {errors.translation_rmse_m, errors.translation_mean_m, errors.rotation_rmse_deg,
             errors.rotation_mean_deg});
  return table;
}

}  // namespace headway::eval
