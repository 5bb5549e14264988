// SPDX-License-Identifier: BSD-3-Clause
// Bindings of tracks and results.
#include <headway/core/detection.h>
#include <headway/core/error.h>
#include <headway/core/track.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <string>

#include "arrays.h"

namespace headway::python {
namespace {

ObjectClass classFrom(const std::string& name) {
  const auto object_class = objectClassFrom(name);
  if (!object_class) throw InputError("object_class: '" + name + "' is not a KITTI class");
  return *object_class;
}

using Edges = std::array<double, 4>;

Detection detectionFrom(const std::string& object_class, double score,
                        const std::optional<Edges>& box2d,
                        const std::optional<Eigen::Vector3d>& centre,
                        const std::optional<Eigen::Vector3d>& size, double yaw) {
  if (centre.has_value() != size.has_value()) {
    throw InputError("centre, size: a 3D box needs both");
  }
  if (!box2d && !centre) throw InputError("a detection needs a 2D box or a 3D box");
  Detection detection;
  detection.object_class = classFrom(object_class);
  detection.score = score;
  detection.evidence.classifier = true;
  if (box2d) detection.box2d = Box2d{(*box2d)[0], (*box2d)[1], (*box2d)[2], (*box2d)[3]};
  if (centre) detection.box3d = Box3d{*centre, size->x(), size->y(), size->z(), yaw};
  return detection;
}

void bindDetection(py::module_& module) {
  py::class_<Detection>(module, "Detection", "One object as a detector reports it in one frame.")
      .def(py::init(&detectionFrom), py::kw_only(), py::arg("object_class"), py::arg("score") = 1.0,
           py::arg("box2d") = py::none(), py::arg("centre") = py::none(),
           py::arg("size") = py::none(), py::arg("yaw") = 0.0,
           "object_class: KITTI's spelling ('Car', 'Pedestrian', ...).\n"
           "box2d: (left, top, right, bottom) [px].\n"
           "centre, size, yaw: the 3D box in the sensor's optical frame: centre of the volume,\n"
           "(length, width, height) [m], KITTI's rotation_y [rad].")
      .def_property_readonly(
          "object_class", [](const Detection& d) { return toString(d.object_class); },
          "KITTI's spelling")
      .def_readonly("score", &Detection::score, "on the detector's own scale, higher is better")
      .def_property_readonly(
          "box2d",
          [](const Detection& d) -> std::optional<Edges> {
            if (!d.box2d) return std::nullopt;
            return Edges{d.box2d->left, d.box2d->top, d.box2d->right, d.box2d->bottom};
          },
          "(left, top, right, bottom) [px]; None without one")
      .def_property_readonly(
          "centre",
          [](const Detection& d) {
            return d.box3d ? std::optional(d.box3d->centre) : std::nullopt;
          },
          "(3,) of the volume, optical frame [m]; None without a 3D box")
      .def_property_readonly(
          "size",
          [](const Detection& d) -> std::optional<Eigen::Vector3d> {
            if (!d.box3d) return std::nullopt;
            return Eigen::Vector3d(d.box3d->length, d.box3d->width, d.box3d->height);
          },
          "(length, width, height) [m]")
      .def_property_readonly(
          "yaw",
          [](const Detection& d) { return d.box3d ? std::optional(d.box3d->yaw) : std::nullopt; },
          "KITTI's rotation_y [rad]");
}

void bindDetections(py::module_& module) {
  py::class_<Detections>(module, "Detections", "All detections of one frame.")
      .def(py::init([](Time time, std::vector<Detection> items,
                       const std::optional<Eigen::Matrix4d>& T_robot_sensor) {
             Detections detections;
             detections.time = time;
             detections.items = std::move(items);
             if (T_robot_sensor) detections.T_robot_sensor = poseFrom(*T_robot_sensor);
             return detections;
           }),
           py::arg("time"), py::arg("items"), py::arg("T_robot_sensor") = py::none(),
           "T_robot_sensor: 4x4, the optical frame of the 3D boxes on the robot; None: the\n"
           "robot's origin, looking forward.")
      .def_readonly("time", &Detections::time, "[s]")
      .def_readonly("items", &Detections::items, "list of Detection")
      .def("__len__", [](const Detections& detections) { return detections.items.size(); });
}

/// Position and covariance at all horizons of one predicted path, as arrays.
py::array_t<double> positionsOf(const PredictedPath& path) {
  py::array_t<double> rows({static_cast<py::ssize_t>(path.points.size()), py::ssize_t{3}});
  auto cells = rows.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) {
    const auto& point = path.points[static_cast<std::size_t>(i)];
    for (int k = 0; k < 3; ++k) cells(i, k) = point.position[k];
  }
  return rows;
}

py::array_t<double> covariancesOf(const PredictedPath& path) {
  py::array_t<double> rows(
      {static_cast<py::ssize_t>(path.points.size()), py::ssize_t{2}, py::ssize_t{2}});
  auto cells = rows.mutable_unchecked<3>();
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) {
    const auto& covariance = path.points[static_cast<std::size_t>(i)].covariance;
    for (int r = 0; r < 2; ++r) {
      for (int c = 0; c < 2; ++c) cells(i, r, c) = covariance(r, c);
    }
  }
  return rows;
}

std::vector<double> horizonsOf(const PredictedPath& path) {
  std::vector<double> horizons;
  for (const auto& point : path.points) horizons.push_back(point.horizon_s);
  return horizons;
}

py::array_t<double> pastOf(const Track& track) {
  py::array_t<double> rows({static_cast<py::ssize_t>(track.recent_path.size()), py::ssize_t{5}});
  auto cells = rows.mutable_unchecked<2>();
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) {
    const auto& point = track.recent_path[static_cast<std::size_t>(i)];
    cells(i, 0) = point.time;
    for (int k = 0; k < 3; ++k) cells(i, 1 + k) = point.position[k];
    cells(i, 4) = point.yaw;
  }
  return rows;
}

std::string describe(const Track& track) {
  return "<headway.Track " + std::to_string(track.id.value) + " " +
         std::string(toString(track.object_class)) + ", " +
         std::string(toString(track.motion_state)) + ">";
}

void bindTrack(py::module_& module) {
  py::class_<PredictedPath>(module, "PredictedPath", "One of a track's predicted paths.")
      .def_readonly("mode", &PredictedPath::mode, "number of the hypothesis")
      .def_readonly("probability", &PredictedPath::probability, "sums to 1 over a track's paths")
      .def_property_readonly("horizons_s", &horizonsOf, "0.1 ... 3.0 after the frame [s]")
      .def_property_readonly("positions", &positionsOf, "(n, 3) box centres, map frame [m]")
      .def_property_readonly("covariances", &covariancesOf, "(n, 2, 2) of (x, y) [m^2]");
  py::class_<Track>(module, "Track", "One tracked object in one frame; map frame.")
      .def_property_readonly(
          "id", [](const Track& track) { return track.id.value; }, "unique in a map")
      .def_property_readonly(
          "object_class", [](const Track& track) { return toString(track.object_class); },
          "KITTI's spelling")
      .def_property_readonly(
          "status", [](const Track& track) { return toString(track.status); },
          "'tentative', 'confirmed', 'coasting' or 'ended'")
      .def_property_readonly(
          "motion", [](const Track& track) { return toString(track.motion_state); },
          "'unknown', 'moving' or 'static'")
      .def_readonly("score", &Track::score, "from the scores of its boxes, higher is better")
      .def_readonly("position", &Track::position, "(3,) box centre [m]")
      .def_readonly("velocity", &Track::velocity, "(3,) [m/s]")
      .def_readonly("yaw", &Track::yaw, "of the front about map z [rad]")
      .def_readonly("yaw_rate", &Track::yaw_rate, "[rad/s]")
      .def_readonly("size", &Track::size, "(length, width, height) [m]")
      .def_readonly("position_covariance", &Track::position_covariance, "(3, 3) [m^2]")
      .def_readonly("velocity_covariance", &Track::velocity_covariance, "(2, 2) [m^2/s^2]")
      .def_readonly("first_seen", &Track::first_seen, "[s]")
      .def_readonly("last_seen", &Track::last_seen, "[s]")
      .def_property_readonly("recent_path", &pastOf, "(n, 5) rows time x y z yaw, oldest first")
      .def_readonly("predictions", &Track::predictions, "the most probable path first")
      .def("__repr__", &describe);
  py::class_<TrackSample>(module, "TrackSample", "A track in one frame: a row of tracks.csv.")
      .def_readonly("frame", &TrackSample::frame, "index of the frame in its recording")
      .def_readonly("time", &TrackSample::time, "[s]")
      .def_readonly("track", &TrackSample::track, "Track in that frame");
}

}  // namespace

void bindTracks(py::module_& module) {
  bindDetection(module);
  bindDetections(module);
  bindTrack(module);
}

namespace {

py::array_t<double> readTrajectory(const std::string& path) {
  if (!io::hasRawlogName(path)) return rowsOf(io::readTum(path));
  const auto truth = io::readTruth(path);
  if (truth.poses.empty()) throw InputError(path + ": contains no poses labelled truth_pose");
  return rowsOf(truth.poses);
}

/// A structured array of numbers, texts and small matrices.
template <typename Row>
class Table {
 public:
  explicit Table(const std::vector<Row>& rows) : rows_(rows) {}

  /// @param type  NumPy's name of the type, such as "f8"
  /// @param get   value of a row: a number, a text, or a matrix of the shape
  template <typename Get>
  void add(const char* name, const char* type, const Get& get,
           const py::tuple& shape = py::tuple()) {
    py::list column;
    for (const auto& row : rows_) column.append(get(row));
    fields_.append(py::make_tuple(name, type, shape));
    columns_.append(py::make_tuple(name, column));
  }

  [[nodiscard]] py::array array() const {
    const auto numpy = py::module_::import("numpy");
    py::array table = numpy.attr("zeros")(rows_.size(), numpy.attr("dtype")(fields_));
    if (rows_.empty()) return table;
    for (const auto& column : columns_) {
      const auto pair = column.cast<py::tuple>();
      table[pair[0]] = pair[1];
    }
    return table;
  }

 private:
  const std::vector<Row>& rows_;
  py::list fields_;
  py::list columns_;
};

py::array readTrackArray(const std::string& path) {
  std::vector<io::ObjectSample> rows;
  {
    const py::gil_scoped_release release;
    rows = io::readObjectCsv(path);
  }
  using Row = io::ObjectSample;
  const auto vector = py::make_tuple(3);
  const auto square = py::make_tuple(2, 2);
  Table<Row> table(rows);
  table.add("frame", "i8", [](const Row& row) { return row.object.frame; });
  table.add("time", "f8", [](const Row& row) { return row.object.time; });
  const auto add = [&](const char* name, const char* type, auto get,
                       const py::tuple& shape = py::tuple()) {
    table.add(
        name, type, [&](const Row& row) { return get(row.object.track); }, shape);
  };
  add("track_id", "i8", [](const Track& track) { return track.id.value; });
  add("class", "U16", [](const Track& track) { return toString(track.object_class); });
  add("status", "U12", [](const Track& track) { return toString(track.status); });
  add("moving", "?", [](const Track& track) { return isMoving(track); });
  add(
      "position", "f8", [](const Track& track) { return track.position; }, vector);
  add("yaw", "f8", [](const Track& track) { return track.yaw; });
  add(
      "size", "f8", [](const Track& track) { return track.size; }, vector);
  add(
      "velocity", "f8", [](const Track& track) { return track.velocity; }, vector);
  add(
      "position_covariance", "f8",
      [](const Track& track) {
        return Eigen::Matrix2d(track.position_covariance.topLeftCorner<2, 2>());
      },
      square);
  add(
      "velocity_covariance", "f8",
      [](const Track& track) { return Eigen::Matrix2d(track.velocity_covariance); }, square);
  table.add("visible", "f8", [](const Row& row) { return row.visible; });
  return table.array();
}

py::array readPredictions(const std::string& path) {
  std::vector<io::PredictionRow> rows;
  {
    const py::gil_scoped_release release;
    rows = io::readPredictionCsv(path);
  }
  using Row = io::PredictionRow;
  Table<Row> table(rows);
  table.add("frame", "i8", [](const Row& row) { return row.frame; });
  table.add("time", "f8", [](const Row& row) { return row.time; });
  table.add("track_id", "i8", [](const Row& row) { return row.id.value; });
  table.add("class", "U16", [](const Row& row) { return toString(row.object_class); });
  table.add("mode", "i8", [](const Row& row) { return row.mode; });
  table.add("probability", "f8", [](const Row& row) { return row.probability; });
  table.add("horizon_s", "f8", [](const Row& row) { return row.point.horizon_s; });
  table.add(
      "position", "f8", [](const Row& row) { return row.point.position; }, py::make_tuple(3));
  table.add(
      "covariance", "f8", [](const Row& row) { return Eigen::Matrix2d(row.point.covariance); },
      py::make_tuple(2, 2));
  return table.array();
}

}  // namespace

void bindResults(py::module_& module) {
  module.def("read_trajectory", &readTrajectory, py::arg("path"),
             "(n, 8) rows time x y z qx qy qz qw of a TUM file, or the truth of a rawlog.");
  module.def("read_tracks", &io::readTrackCsv, py::arg("path"),
             "TrackSamples of tracks.csv or tracks_smoothed.csv; read_track_array() gives arrays.");
  module.def(
      "read_track_array", &readTrackArray, py::arg("path"),
      "tracks.csv, tracks_smoothed.csv, or the objects.csv of a simulation as a structured\n"
      "array with a row for each track in each frame, in the map frame: frame, time [s],\n"
      "track_id, class, status, moving, position (3) [m], yaw [rad], size (3: length, width,\n"
      "height) [m], velocity (3) [m/s], position_covariance (2, 2) of x, y [m^2],\n"
      "velocity_covariance (2, 2) [m^2/s^2], visible (ratio 0 to 1 in objects.csv, else 1).");
  module.def(
      "read_predictions", &readPredictions, py::arg("path"),
      "predictions.csv as a structured array with a row for each track, mode and horizon, in\n"
      "the map frame: frame, time [s], track_id, class, mode, probability (sums to 1 over\n"
      "modes), horizon_s [s], position (3) [m], covariance (2, 2) of x, y [m^2].");
}

}  // namespace headway::python
