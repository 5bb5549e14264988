// SPDX-License-Identifier: BSD-3-Clause
// Bindings of the map.
#include <headway/core/error.h>
#include <headway/map/map_file.h>
#include <headway/map/map_query.h>

#include "arrays.h"

namespace headway::python {
namespace {

py::array_t<double> landmarksOf(const map::PerceptionMap& map) {
  const auto& landmarks = map.staticMap()->landmarks;
  py::array_t<double> rows({static_cast<py::ssize_t>(landmarks.size()), py::ssize_t{3}});
  auto cells = rows.mutable_unchecked<2>();
  py::ssize_t i = 0;
  for (const auto& landmark : landmarks) {
    for (int k = 0; k < 3; ++k) cells(i, k) = landmark.position[k];
    ++i;
  }
  return rows;
}

py::array_t<double> keyframesOf(const map::PerceptionMap& map) {
  std::vector<Stamped<Pose>> poses;
  for (const auto& keyframe : map.staticMap()->keyframes) {
    poses.push_back({keyframe.time, keyframe.T_map_robot});
  }
  return rowsOf(poses);
}

/// The occupancy grid as probabilities.
struct Grid {
  py::array_t<float> occupancy;
  Eigen::Vector2d origin;
  double resolution_m;
};

std::optional<Grid> gridOf(const map::PerceptionMap& map) {
  const auto grid = map.staticGrid();
  if (!grid) return std::nullopt;
  const auto rows = static_cast<py::ssize_t>(grid->getSizeY()),
             columns = static_cast<py::ssize_t>(grid->getSizeX());
  py::array_t<float> occupancy({rows, columns});
  auto cells = occupancy.mutable_unchecked<2>();
  for (py::ssize_t y = 0; y < rows; ++y) {
    for (py::ssize_t x = 0; x < columns; ++x) {
      cells(y, x) = 1.0F - grid->getCell(static_cast<int>(x), static_cast<int>(y));
    }
  }
  return Grid{occupancy, {grid->getXMin(), grid->getYMin()}, grid->getResolution()};
}

map::Collision timeToCollision(const map::MapQuery& query, double length_m, double width_m,
                               const Rows& path) {
  if (path.ndim() != 2 || path.shape(1) != 4) {
    throw InputError("path: must be an array (n, 4) of rows time x y yaw");
  }
  if (!(length_m >= 0.0 && width_m >= 0.0)) {
    throw InputError("length_m, width_m: must not be negative");
  }
  std::vector<map::TimedPose> poses;
  const auto cells = path.unchecked<2>();
  for (py::ssize_t i = 0; i < cells.shape(0); ++i) {
    poses.push_back({cells(i, 0), {cells(i, 1), cells(i, 2)}, cells(i, 3)});
    const bool is_finite = std::isfinite(cells(i, 0)) && poses.back().position.allFinite() &&
                           std::isfinite(cells(i, 3));
    if (!is_finite || (i > 0 && cells(i, 0) < cells(i - 1, 0))) {
      throw InputError("path: times must ascend, and all numbers must be finite");
    }
  }
  return query.timeToCollision({length_m, width_m}, poses);
}

template <typename Answer>
py::class_<Answer> answer(py::module_& module, const char* name, const char* text) {
  return py::class_<Answer>(module, name, text)
      .def_property_readonly(
          "status", [](const Answer& answer) { return toString(answer.status); },
          "'known', 'stale_map', 'empty_map', 'unknown_place' or 'unknown_time'; only 'known' is\n"
          "safe to act on");
}

void bindAnswers(py::module_& module) {
  answer<map::Occupancy>(module, "Occupancy", "Occupancy of a point at one time.")
      .def_readonly("probability", &map::Occupancy::probability, "occupied by anything")
      .def_readonly("static_probability", &map::Occupancy::static_probability,
                    "in the static grid; 0.5: never observed")
      .def_readonly("moving_probability", &map::Occupancy::moving_probability, "by a track");
  py::class_<map::NearTrack>(module, "NearTrack", "A track near a point, at its likeliest place.")
      .def_property_readonly(
          "id", [](const map::NearTrack& near) { return near.obstacle.id.value; }, "that of Track")
      .def_property_readonly(
          "object_class",
          [](const map::NearTrack& near) { return toString(near.obstacle.object_class); },
          "KITTI's spelling")
      .def_property_readonly(
          "centre", [](const map::NearTrack& near) { return near.obstacle.centre; }, "(2,) [m]")
      .def_property_readonly(
          "velocity", [](const map::NearTrack& near) { return near.obstacle.velocity; },
          "(2,) [m/s]")
      .def_readonly("distance_m", &map::NearTrack::distance_m,
                    "from the point to the edge of the footprint; 0 inside it [m]")
      .def_readonly("sigma_m", &map::NearTrack::sigma_m, "of that distance [m]");
  answer<map::NearTracks>(module, "NearTracks", "Tracks near a point, the nearest first.")
      .def_readonly("items", &map::NearTracks::items, "list of NearTrack, the nearest first");
  answer<map::Collision>(module, "Collision", "Result of checking a planned path. Times from now.")
      .def_property_readonly("is_free", &map::Collision::isFree,
                             "whether the whole path is known to be free: the condition to drive")
      .def_readonly("probability", &map::Collision::probability, "of a contact at the worst time")
      .def_readonly("earliest_s", &map::Collision::earliest_s, "first contact; None: none [s]")
      .def_readonly("likely_s", &map::Collision::likely_s, "first with probability 0.5 [s]")
      .def_readonly("unknown_from_s", &map::Collision::unknown_from_s,
                    "first time without a known answer; None: none [s]")
      .def_property_readonly(
          "with_track",
          [](const map::Collision& collision) -> std::optional<std::int64_t> {
            if (!collision.with) return std::nullopt;
            return collision.with->value;
          },
          "id of the track at the worst time; None: no contact, or the static grid");
}

void bindQuery(py::module_& module) {
  py::class_<map::MapQuery>(module, "MapQuery", "Questions to one map at one time.")
      .def_property_readonly(
          "status", [](const map::MapQuery& query) { return toString(query.status()); },
          "'known', 'stale_map' or 'empty_map'")
      .def_property_readonly("age_s", &map::MapQuery::age_s,
                             "time since the tracks' newest frame [s]")
      .def("occupancy_at", &map::MapQuery::occupancyAt, py::arg("x"), py::arg("y"), py::arg("time"),
           "map frame [m], time not before now [s]")
      .def("tracks_near", &map::MapQuery::tracksNear, py::arg("place"), py::arg("radius_m"),
           py::arg("time"), "place: (x, y), map frame [m]")
      .def("time_to_collision", &timeToCollision, py::kw_only(), py::arg("length_m"),
           py::arg("width_m"), py::arg("path"),
           "path: (n, 4) rows time x y yaw, of the centre of a robot of that length and width");
}

}  // namespace

void bindMap(py::module_& module) {
  bindAnswers(module);
  bindQuery(module);
  py::class_<Grid>(module, "Grid", "Occupancy grid of free ground and obstacles.")
      .def_readonly("occupancy", &Grid::occupancy,
                    "(ny, nx) float32, probability that a cell is occupied; 0.5: never observed.\n"
                    "Row 0 has the least y.")
      .def_readonly("origin", &Grid::origin, "(2,) corner of cell [0, 0], map frame [m]")
      .def_readonly("resolution_m", &Grid::resolution_m, "side of a cell [m]");
  py::class_<map::PerceptionMap>(module, "Map",
                                 "The map at one moment: a snapshot, which later frames do not\n"
                                 "change. Each property makes a new array.")
      .def_property_readonly("landmarks", &landmarksOf, "(n, 3) [m]")
      .def_property_readonly("keyframes", &keyframesOf, "(n, 8) rows time x y z qx qy qz qw")
      .def_property_readonly("grid", &gridOf, "Grid; None before ground was observed")
      .def_property_readonly(
          "tracks", [](const map::PerceptionMap& map) { return map.movingObjects().tracks(); },
          "list of Track of the newest frame")
      .def_property_readonly(
          "time", [](const map::PerceptionMap& map) { return map.movingObjects().time(); },
          "of the tracks [s]")
      .def(
          "at",
          [](const map::PerceptionMap& map, Time now, double max_age_s) {
            map::MapQueryParams params;
            params.max_age_s = max_age_s;
            return map::MapQuery(map, now, params);
          },
          py::arg("now"), py::kw_only(), py::arg("max_age_s") = 0.5,
          "Questions at the time `now` [s]; an older map than max_age_s is stale.");
  module.def(
      "load_map", [](const std::string& path) { return map::loadMap(path).map; }, py::arg("path"),
      "The map of a map.headway. Raises InputError if it is missing, damaged or of another\n"
      "version.");
}

}  // namespace headway::python
