// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/figures.h>
#include <headway/eval/moving_object_error.h>
#include <headway/eval/object_motion_error.h>

#include <array>
#include <nlohmann/json.hpp>

namespace headway::eval {
namespace {

using OrderedJson = nlohmann::ordered_json;

OrderedJson valueOrNull(const std::optional<double>& value) {
  return value ? OrderedJson(*value) : OrderedJson(nullptr);
}

OrderedJson countsJson(const MovingCounts& counts) {
  OrderedJson json;
  json["recall"] = valueOrNull(counts.recall());
  json["recall_as_class"] = valueOrNull(counts.recallAsClass());
  json["precision"] = valueOrNull(counts.precision());
  json["precision_as_class"] = valueOrNull(counts.precisionAsClass());
  json["labels"] = counts.labels;
  json["found"] = counts.found;
  json["found_as_class"] = counts.found_as_class;
  json["rows"] = counts.rows;
  json["right"] = counts.right;
  json["right_as_class"] = counts.right_as_class;
  return json;
}

OrderedJson groupsJson(const std::map<std::string, MovingCounts>& groups) {
  auto json = OrderedJson::object();
  for (const auto& [name, counts] : groups) json[name] = countsJson(counts);
  return json;
}

OrderedJson tracksJson(const std::vector<MovingTrack>& tracks) {
  auto json = OrderedJson::array();
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

void addRow(plot::TextTable& table, const std::string& name, const MovingCounts& counts) {
  table.push_back({name, plot::percentText(counts.recall(), 1),
                   plot::percentText(counts.recallAsClass(), 1), std::to_string(counts.labels),
                   plot::percentText(counts.precision(), 1),
                   plot::percentText(counts.precisionAsClass(), 1), std::to_string(counts.rows)});
}

void addMotion(plot::TextTable& table, const std::string& name, std::size_t frames,
               const std::array<std::optional<double>, 4>& figures) {
  table.push_back({name, std::to_string(frames), plot::fixedText(figures[0], 3),
                   plot::fixedText(figures[1], 3), plot::fixedText(figures[2], 2),
                   plot::fixedText(figures[3], 2)});
}

}  // namespace

OrderedJson toJson(const MovingObjectError& error) {
  OrderedJson json;
  json["frames"] = error.frames;
  json["all"] = countsJson(error.all);
  json["within_40m"] = countsJson(error.within_40m);
  json["classes"] = groupsJson(error.classes);
  json["ranges_m"] = groupsJson(error.ranges);
  json["occlusion"] = groupsJson(error.occlusion);
  json["moving_tracks"] = error.tracks.size();
  json["false_tracks"] = error.false_tracks;
  json["false_tracks_per_100_frames"] = valueOrNull(error.falseTracksPer100Frames());
  json["duplicate_rows"] = error.duplicate_rows;
  json["rows_ignored"] = error.ignored;
  json["tracks"] = tracksJson(error.tracks);
  return json;
}

OrderedJson toJson(const LabelledObjectError& error) {
  const auto counts = [](const LabelledObjectCounts& c) {
    return OrderedJson{{"recall", valueOrNull(c.recall())},
                       {"class_ratio", valueOrNull(c.classRatio())},
                       {"labels", c.labels},
                       {"found", c.found},
                       {"found_as_class", c.found_as_class}};
  };
  OrderedJson json;
  json["max_range_m"] = error.max_range_m;
  json["max_occlusion"] = error.max_occlusion;
  json["all"] = counts(error.all);
  json["classes"] = OrderedJson::object();
  for (const auto& [name, of_class] : error.classes) json["classes"][name] = counts(of_class);
  return json;
}

OrderedJson toJson(const ObjectMotionErrors& errors) {
  OrderedJson json;
  json["translation_rmse_m"] = valueOrNull(errors.translation_rmse_m);
  json["translation_mean_m"] = valueOrNull(errors.translation_mean_m);
  json["rotation_rmse_deg"] = valueOrNull(errors.rotation_rmse_deg);
  json["rotation_mean_deg"] = valueOrNull(errors.rotation_mean_deg);
  json["frames"] = errors.frames;
  json["objects"] = OrderedJson::array();
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

plot::TextTable tableOf(const MovingObjectError& error) {
  plot::TextTable table = {
      {"moving objects", "recall %", "as class %", "labels", "precision %", "as class %", "rows"}};
  addRow(table, "all", error.all);
  addRow(table, "within 40 m", error.within_40m);
  for (const auto& [name, counts] : error.classes) addRow(table, name, counts);
  for (const auto& [name, counts] : error.ranges) addRow(table, name + " m", counts);
  for (const auto& [name, counts] : error.occlusion) addRow(table, "occlusion " + name, counts);
  return table;
}

plot::TextTable tableOf(const LabelledObjectError& error) {
  plot::TextTable table = {{"labels to " + plot::fixedText(error.max_range_m, 0) +
                                " m, occlusion to " + std::to_string(error.max_occlusion),
                            "recall %", "labels", "found", "class right %", "as class"}};
  const auto add = [&](const std::string& name, const LabelledObjectCounts& counts) {
    table.push_back({name, plot::percentText(counts.recall(), 1), std::to_string(counts.labels),
                     std::to_string(counts.found), plot::percentText(counts.classRatio(), 1),
                     std::to_string(counts.found_as_class)});
  };
  add("all", error.all);
  for (const auto& [name, counts] : error.classes) add(name, counts);
  return table;
}

plot::TextTable tableOf(const ObjectMotionErrors& errors) {
  plot::TextTable table = {
      {"motion per frame", "frames", "RMSE m", "mean m", "RMSE deg", "mean deg"}};
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
