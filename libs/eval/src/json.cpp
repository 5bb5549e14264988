#include <headway/eval/json.h>
#include <headway/eval/prediction_error.h>
#include <headway/eval/track_error.h>
#include <headway/eval/trajectory_error.h>

#include <array>
#include <nlohmann/json.hpp>
#include <string>

namespace headway::eval {
namespace {

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

/// One object for each class and one for all.
template <typename Errors>
Json byClass(const Errors& errors) {
  Json json;
  for (const auto& [object_class, error] : errors.classes) {
    json[std::string(toString(object_class))] = toJson(error);
  }
  json["all"] = toJson(errors.all);
  return json;
}

}  // namespace

Json toJson(const PredictionErrors& errors) { return byClass(errors); }

Json toJson(const TrackErrors& errors) { return byClass(errors); }

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

}  // namespace headway::eval
