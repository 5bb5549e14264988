// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/trajectory_error.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <nlohmann/json.hpp>

#include "arrays.h"

namespace headway::python {
namespace {

py::object fromJson(const nlohmann::ordered_json& json) {
  return py::module_::import("json").attr("loads")(json.dump());
}

eval::Alignment alignmentFrom(const std::string& name) {
  if (name == "se3") return eval::Alignment::kSe3;
  if (name == "origin") return eval::Alignment::kOrigin;
  if (name == "none") return eval::Alignment::kNone;
  if (name == "scale") return eval::Alignment::kScale;
  throw InputError("align: '" + name + "' is none of se3, origin, scale, none");
}

py::object evaluateTrajectory(const Rows& truth, const Rows& estimate, const std::string& align,
                              double max_difference_s) {
  eval::TrajectoryErrorParams params;
  params.alignment = alignmentFrom(align);
  const auto true_poses = trajectoryFrom(truth, "truth");
  const auto estimated = trajectoryFrom(estimate, "estimate");
  const auto pairs = eval::pairByTime(true_poses, estimated, max_difference_s);
  return fromJson(eval::toJson(eval::trajectoryError(pairs, params)));
}

py::array_t<double> readTrajectory(const std::string& path) {
  if (!io::hasRawlogName(path)) return rowsOf(io::readTum(path));
  const auto truth = io::readTruth(path);
  if (truth.poses.empty()) throw InputError(path + ": contains no poses labelled truth_pose");
  return rowsOf(truth.poses);
}

}  // namespace

void bindResults(py::module_& module) {
  module.def("read_trajectory", &readTrajectory, py::arg("path"),
             "(n, 8) rows time x y z qx qy qz qw of a TUM file, or the truth of a rawlog.");
  module.def("read_tracks", &io::readTrackCsv, py::arg("path"),
             "TrackSamples of tracks.csv or tracks_smoothed.csv.");
  module.def("evaluate_trajectory", &evaluateTrajectory, py::arg("truth"), py::arg("estimate"),
             py::kw_only(), py::arg("align") = "se3", py::arg("max_difference_s") = 0.02,
             "Errors of a trajectory, the figures of `headway-eval trajectory --json`: both are\n"
             "(n, 8) rows time x y z qx qy qz qw; align: 'se3', 'origin', 'scale' or 'none'.");
}

}  // namespace headway::python
