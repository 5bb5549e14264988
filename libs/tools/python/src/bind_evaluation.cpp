// SPDX-License-Identifier: BSD-3-Clause
// Bindings of the evaluation.
#include <headway/core/error.h>
#include <headway/eval/dense_error.h>
#include <headway/eval/figures.h>
#include <headway/eval/grid_error.h>
#include <headway/eval/moving_object_error.h>
#include <headway/eval/prediction_evaluation.h>
#include <headway/eval/track_error.h>
#include <headway/eval/trajectory_error.h>

#include <nlohmann/json.hpp>

#include "arrays.h"

namespace headway::python {
namespace {

using OptionalPath = std::optional<std::string>;

/// Computes figures while other Python threads run, and returns them as a dict.
template <typename Compute>
py::dict figuresOf(const Compute& compute) {
  std::string text;
  {
    const py::gil_scoped_release release;
    text = nlohmann::ordered_json(compute()).dump();
  }
  return py::module_::import("json").attr("loads")(text);
}

eval::Alignment alignmentFrom(const std::string& name) {
  if (name == "se3") return eval::Alignment::kSe3;
  if (name == "origin") return eval::Alignment::kOrigin;
  if (name == "none") return eval::Alignment::kNone;
  if (name == "scale") return eval::Alignment::kScale;
  throw InputError("align: '" + name + "' is none of se3, origin, scale, none");
}

py::dict evaluateTrajectory(const Rows& truth, const Rows& estimate, const std::string& align,
                            double max_difference_s, const std::vector<double>& segments_m) {
  eval::TrajectoryErrorParams params;
  params.alignment = alignmentFrom(align);
  params.segment_lengths_m = segments_m;
  params.finds_rotation = true;
  for (const double length : segments_m) {
    if (!(length > 0.0)) throw InputError("segments_m: must be positive");
  }
  const auto true_poses = trajectoryFrom(truth, "truth");
  const auto estimated = trajectoryFrom(estimate, "estimate");
  return figuresOf([&] {
    const auto pairs = eval::pairByTime(true_poses, estimated, max_difference_s);
    return eval::toJson(eval::trajectoryError(pairs, params));
  });
}

eval::TrackErrorParams trackParams(const std::string& metric,
                                   const std::vector<std::string>& classes,
                                   std::optional<double> min_overlap) {
  eval::TrackErrorParams params;
  if (metric == "2d") {
    params.metric = eval::BoxMetric::k2d;
    params.min_overlap = 0.5;
  } else if (metric != "3d") {
    throw InputError("metric: '" + metric + "' is neither 2d nor 3d");
  }
  if (min_overlap) params.min_overlap = *min_overlap;
  if (!(params.min_overlap > 0.0 && params.min_overlap <= 1.0)) {
    throw InputError("min_overlap: must be above 0 and at most 1");
  }
  params.classes.clear();
  for (const auto& name : classes) {
    const auto object_class = objectClassFrom(name);
    if (!object_class) throw InputError("classes: '" + name + "' is not a KITTI class");
    params.classes.push_back(*object_class);
  }
  if (classes.empty()) throw InputError("classes: the list is empty");
  return params;
}

py::dict evaluateTracks(const std::string& truth, const std::string& estimate,
                        const std::string& metric, const std::vector<std::string>& classes,
                        std::optional<double> min_overlap, const OptionalPath& raw) {
  const auto params = trackParams(metric, classes, min_overlap);
  return figuresOf([&] {
    return toJson(eval::evaluateTracks({truth, estimate, raw.value_or("")}, params));
  });
}

py::dict evaluateMovers(const std::string& truth, const std::string& poses,
                        const std::string& estimate) {
  return figuresOf([&] { return toJson(eval::evaluateMovers(truth, poses, estimate)); });
}

py::dict evaluatePredictions(const std::string& truth, const std::string& poses,
                             const std::string& estimate, const OptionalPath& extrinsic) {
  return figuresOf([&] {
    const auto sequences =
        eval::readPredictionInput({truth, poses, estimate, extrinsic.value_or("")});
    const auto errors = eval::evaluateEstimate(sequences);
    eval::requireCases(errors, truth);
    return toJson(errors);
  });
}

py::dict evaluateGrid(const std::string& truth, const std::string& estimate,
                      std::optional<double> min_obstacle_height_m,
                      std::optional<double> max_obstacle_height_m) {
  for (const auto& height : {min_obstacle_height_m, max_obstacle_height_m}) {
    if (height && !(*height > 0.0)) throw InputError("heights of obstacles: must be positive");
  }
  return figuresOf([&] {
    return toJson(eval::evaluateGrid(
        truth, estimate,
        {min_obstacle_height_m.value_or(0.0), max_obstacle_height_m.value_or(0.0), 0.0}));
  });
}

py::dict evaluateDense(const std::string& truth, const std::string& estimate,
                       const OptionalPath& rawlog) {
  return figuresOf(
      [&] { return toJson(eval::evaluateDense(truth, estimate, rawlog.value_or(""))); });
}

void bindObjectEvaluations(py::module_& module) {
  module.def(
      "evaluate_tracks", &evaluateTracks, py::arg("truth"), py::arg("estimate"), py::kw_only(),
      py::arg("metric") = "3d",
      py::arg("classes") = std::vector<std::string>{"Car", "Pedestrian", "Cyclist"},
      py::arg("min_overlap") = py::none(), py::arg("raw") = py::none(),
      "Errors of tracks, the figures of `headway-eval tracks --json`. truth: KITTI tracking\n"
      "labels or the objects.csv of a simulation; estimate: KITTI results or tracks.csv; or\n"
      "folders of such files of the same names. metric: '3d' or '2d' boxes; min_overlap:\n"
      "None for 0.25 (3d), 0.5 (2d); raw: detections, whose positions are evaluated too.");
  module.def(
      "evaluate_movers", &evaluateMovers, py::arg("truth"), py::arg("poses"), py::arg("estimate"),
      "Moving objects found, the figures of `headway-eval movers --json`. truth: KITTI\n"
      "tracking labels; poses: true pose of every frame, as KITTI (camera), TUM (robot), or\n"
      "a rawlog with truth_pose; estimate: output folder of headway-replay.");
  module.def(
      "evaluate_predictions", &evaluatePredictions, py::arg("truth"), py::arg("poses"),
      py::arg("estimate"), py::kw_only(), py::arg("extrinsic") = py::none(),
      "Errors of predictions, the figures of `headway-eval predictions --json`. truth: KITTI\n"
      "tracking labels; poses: of every frame, as KITTI (camera) or TUM (robot); estimate:\n"
      "predictions.csv; or folders of such files of the same names. extrinsic: a\n"
      "calibration.yaml with T_robot_cam; None: robot axes at the camera.");
}

void bindMapEvaluations(py::module_& module) {
  module.def(
      "evaluate_grid", &evaluateGrid, py::arg("truth"), py::arg("estimate"), py::kw_only(),
      py::arg("min_obstacle_height_m") = py::none(), py::arg("max_obstacle_height_m") = py::none(),
      "Errors of the occupancy grid, the figures of `headway-eval grid --json`. truth: folder\n"
      "written by headway-sim --depth --masks; estimate: output folder of headway-replay;\n"
      "heights of what is an obstacle [m], None: as in the replay.");
  module.def("evaluate_dense", &evaluateDense, py::arg("truth"), py::arg("estimate"), py::kw_only(),
             py::arg("rawlog") = py::none(),
             "Errors of the dense map, the figures of `headway-eval dense --json`. truth and\n"
             "estimate: as of evaluate_grid(), the replay of the whole rawlog; rawlog: of that\n"
             "truth, to match its pairs too.");
}

}  // namespace

void bindEvaluation(py::module_& module) {
  module.def("evaluate_trajectory", &evaluateTrajectory, py::arg("truth"), py::arg("estimate"),
             py::kw_only(), py::arg("align") = "se3", py::arg("max_difference_s") = 0.02,
             py::arg("segments_m") = eval::TrajectoryErrorParams{}.segment_lengths_m,
             "Errors of a trajectory, the figures of `headway-eval trajectory --json`: both are\n"
             "(n, 8) rows time x y z qx qy qz qw; align: 'se3', 'origin', 'scale' or 'none';\n"
             "segments_m: lengths of KITTI's path segments [m].");
  bindObjectEvaluations(module);
  bindMapEvaluations(module);
}

}  // namespace headway::python
