// SPDX-License-Identifier: BSD-3-Clause
// Bindings of perception and sessions.
#include <headway/core/error.h>
#include <headway/map/map_file.h>
#include <headway/run/session.h>

#include <sstream>

#include "arrays.h"

namespace headway::python {
namespace {

using pipeline::Perception;
using pipeline::PerceptionUpdate;

std::string textOf(const py::handle& value) {
  if (py::isinstance<py::bool_>(value)) return value.cast<bool>() ? "true" : "false";
  return py::str(value);
}

pipeline::PerceptionParams paramsFrom(const py::dict& config,
                                      const std::vector<std::string>& config_files, bool live) {
  pipeline::PerceptionParams values;
  Params params;
  values.describe(params);
  for (const auto& file : config_files) params.loadFile(file);
  for (const auto& [key, value] : config) params.set(textOf(key) + "=" + textOf(value));
  for (const auto& text : params.warnings()) {
    if (PyErr_WarnEx(PyExc_FutureWarning, text.c_str(), 1) != 0) throw py::error_already_set();
  }
  return live ? pipeline::PerceptionParams::live(values) : values;
}

/// Perception with the text of its parameters, which a map file contains.
class Pipeline {
 public:
  Pipeline(const std::shared_ptr<StereoCamera>& camera, const pipeline::PerceptionParams& params)
      : perception_(camera, params) {
    auto values = params;
    Params text;
    values.describe(text);
    std::ostringstream out;
    text.print(out);
    configuration_ = out.str();
  }

  Perception& perception() { return perception_; }

  void saveMap(const std::string& path) {
    auto stored = perception_.stored();
    stored.configuration = configuration_;
    map::saveMap(path, std::move(stored));
  }

 private:
  Perception perception_;
  std::string configuration_;
};

std::vector<Stamped<Pose>> trackedPoses(const Perception& perception) {
  std::vector<Stamped<Pose>> poses;
  perception.visitTrajectory([&](const slam::FrameEstimate& frame) {
    if (frame.tracked) poses.push_back({frame.time, frame.T_map_robot});
  });
  return poses;
}

const char* doubtOf(const PerceptionUpdate& update) {
  switch (update.camera.doubt) {
    case slam::Doubt::kImages:
      return "images";
    case slam::Doubt::kFrozen:
      return "frozen";
    case slam::Doubt::kOdometry:
      return "odometry";
    case slam::Doubt::kSpeed:
      return "speed";
    case slam::Doubt::kNone:
      break;
  }
  return "";
}

void bindFinding(py::module_& module) {
  py::class_<pipeline::Finding>(module, "Finding",
                                "What is wrong with the input, found in a frame.")
      .def_readonly("name", &pipeline::Finding::name, "as in Perception.warnings")
      .def_readonly("frame", &pipeline::Finding::frame, "index of the frame")
      .def_readonly("text", &pipeline::Finding::text, "what is wrong and what to do")
      .def_property_readonly(
          "is_fatal",
          [](const pipeline::Finding& finding) {
            return finding.severity == pipeline::Severity::kFatal;
          },
          "whether no pose is to be trusted from this frame on; else results are degraded");
}

void bindUpdate(py::module_& module) {
  py::class_<PerceptionUpdate>(module, "Update", "Result of one frame.")
      .def_readonly("frame", &PerceptionUpdate::frame, "index of the frame")
      .def_readonly("time", &PerceptionUpdate::time, "[s]")
      .def_property_readonly(
          "status", [](const PerceptionUpdate& update) { return toString(update.camera.status); },
          "'tracked', 'tracked_in_new_submap' (the place of the submap in the map is not known), "
          "'unreliable' or 'lost'; only if tracked is the pose to be trusted")
      .def_property_readonly("doubt", &doubtOf,
                             "of 'unreliable': 'images', 'frozen', 'odometry' or 'speed'; else ''")
      .def_property_readonly(
          "T_map_robot",
          [](const PerceptionUpdate& update) { return update.camera.T_map_robot.matrix(); },
          "4x4, pose of the robot; jumps where the map is corrected")
      .def_property_readonly(
          "T_odom_robot",
          [](const PerceptionUpdate& update) { return update.camera.T_odom_robot.matrix(); },
          "4x4, the same in the odometry frame; drifts and never jumps")
      .def_property_readonly(
          "T_map_odom",
          [](const PerceptionUpdate& update) { return update.camera.T_map_odom.matrix(); },
          "4x4, the odometry frame in the map")
      .def_property_readonly(
          "map_revision",
          [](const PerceptionUpdate& update) {
            const slam::MapRevision& revision = update.camera.revision;
            return std::pair<std::uint64_t, std::string>(revision.number, toString(revision.cause));
          },
          "(number, cause) of the newest change of the map")
      .def_property_readonly(
          "covariance", [](const PerceptionUpdate& update) { return update.camera.covariance; },
          "(6, 6) of the pose: translation [m], rotation [rad], along the robot's axes")
      .def_property_readonly(
          "is_keyframe", [](const PerceptionUpdate& update) { return update.camera.is_keyframe; },
          "whether the map keeps this frame's pose and landmarks")
      .def_property_readonly(
          "inliers", [](const PerceptionUpdate& update) { return update.camera.inliers; },
          "landmarks that the pose rests on")
      .def_property_readonly(
          "tracks", [](const PerceptionUpdate& update) { return update.objects.tracks; },
          "tentative, confirmed and coasting ones, by id, in the map")
      .def_readonly("tracks_odom", &PerceptionUpdate::tracks_odom, "the same in the odometry frame")
      .def_property_readonly(
          "finalised", [](const PerceptionUpdate& update) { return update.objects.finalised; },
          "smoothed samples that no later frame will change")
      .def_readonly("detections", &PerceptionUpdate::detections,
                    "Detections of all sources; None: no detector ran")
      .def_property_readonly(
          "detections_dropped",
          [](const PerceptionUpdate& update) { return update.objects.detections_dropped; },
          "number of unused detections by reason")
      .def_readonly("findings", &PerceptionUpdate::findings, "[Finding] of this frame");
}

py::dict warningsOf(Pipeline& pipeline) {
  py::dict warnings;
  for (const auto& [name, warning] : pipeline.perception().warnings()) {
    warnings[py::str(name)] = py::make_tuple(warning.count, warning.first_frame, warning.text);
  }
  return warnings;
}

py::class_<Pipeline> bindPipeline(py::module_& module) {
  return py::class_<Pipeline>(module, "Perception",
                              "The whole pipeline: frames in, poses, tracks and the map out. Same\n"
                              "frames and configuration, same results, as headway-replay gives.")
      .def(py::init([](const std::shared_ptr<StereoCamera>& camera, const py::dict& config,
                       const std::vector<std::string>& config_files, bool live) {
             return std::make_unique<Pipeline>(camera, paramsFrom(config, config_files, live));
           }),
           py::arg("camera"), py::kw_only(), py::arg("config") = py::dict(),
           py::arg("config_files") = std::vector<std::string>(), py::arg("live") = false,
           "camera: of all frames. config: {'section.key': value}, after config_files (.ini).\n"
           "live: corrections of the map run beside the tracking, so that results depend on\n"
           "timing. Raises InputError for unknown keys and values out of range.");
}

/// A session over the frames of any Python iterable, itself an iterator over frames and results.
class FrameSession : public run::Source {
 public:
  FrameSession(const py::iterable& frames, Pipeline& pipeline)
      : frames_(py::iter(frames)), session_(*this, pipeline.perception()) {}

  std::pair<std::shared_ptr<RecordedFrame>, PerceptionUpdate> nextResult() {
    auto result = session_.next();
    if (!result) session_.complete();
    if (!result) throw py::stop_iteration();
    return {std::make_shared<RecordedFrame>(std::move(result->frame)), std::move(result->update)};
  }

  [[nodiscard]] std::string name() const override { return "frames"; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return nullptr; }
  [[nodiscard]] run::SourceReport report() const override { return {}; }
  [[nodiscard]] std::optional<LiveFrame> next(const StopCondition& /*stop*/) override {
    const py::gil_scoped_acquire acquire;
    const auto item = py::reinterpret_steal<py::object>(PyIter_Next(frames_.ptr()));
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    if (!item) return std::nullopt;
    return LiveFrame{item.cast<RecordedFrame>(), monotonicSeconds()};
  }

 private:
  py::iterator frames_;
  run::Session session_;
};

void bindSession(py::module_& module) {
  py::class_<FrameSession>(module, "Session",
                           "A run: iterate over it for (frame, update). After the last frame the\n"
                           "perception is finished.")
      .def(py::init<const py::iterable&, Pipeline&>(), py::arg("frames"), py::arg("perception"),
           py::keep_alive<1, 3>(),
           "frames: a RawlogSource, or any other iterable of Frame in order of time.")
      .def(
          "__iter__", [](FrameSession& session) { return &session; },
          py::return_value_policy::reference)
      .def("__next__", &FrameSession::nextResult, py::call_guard<py::gil_scoped_release>());
}

}  // namespace

void bindPerception(py::module_& module) {
  bindFinding(module);
  bindUpdate(module);
  const py::call_guard<py::gil_scoped_release> released;
  bindPipeline(module)
      .def(
          "process",
          [](Pipeline& pipeline, const RecordedFrame& frame) {
            return pipeline.perception().process(frame);
          },
          released, py::arg("frame"),
          "Processes one frame, in order of time; other Python threads run meanwhile.")
      .def(
          "finish", [](Pipeline& pipeline) { pipeline.perception().finish(); }, released,
          "Waits for corrections in the background, of live=True, after the last frame.")
      .def(
          "flush", [](Pipeline& pipeline) { return pipeline.perception().flush(); }, released,
          "The samples still in the smoothing windows; call once, after the last frame.")
      .def(
          "resume",
          [](Pipeline& pipeline, const std::string& path) {
            pipeline.perception().resume(map::loadMap(path));
          },
          released, py::arg("path"),
          "Continues in a stored map (map.headway), before the first frame.")
      .def("save_map", &Pipeline::saveMap, released, py::arg("path"),
           "Writes map.headway, for load_map(), resume() and headway-replay --load-map.")
      .def_property_readonly(
          "map", [](Pipeline& pipeline) { return pipeline.perception().map(); },
          "Map after the last frame, a snapshot")
      .def_property_readonly(
          "trajectory",
          [](Pipeline& pipeline) { return rowsOf(trackedPoses(pipeline.perception())); },
          "(n, 8) rows time x y z qx qy qz qw of the tracked frames, with all corrections so far")
      .def_property_readonly("warnings", &warningsOf,
                             "{name: (count, first frame, text)} of conditions of the input that\n"
                             "degrade the results");
  bindSession(module);
}

}  // namespace headway::python
