// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include "arrays.h"

namespace headway::python {
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
