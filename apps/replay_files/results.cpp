// SPDX-License-Identifier: BSD-3-Clause
#include "results.h"

#include <set>
#include <string>

namespace headway::replay {
namespace {

const std::set<std::string>& resultNames() {
  static const std::set<std::string> names = {"calibration.yaml",
                                              "detections.csv",
                                              "lost.jpg",
                                              "map.headway",
                                              "map_dense.ply",
                                              "map_geo.json",
                                              "map.simplemap",
                                              "map_grid.gridmap.gz",
                                              "map_grid.png",
                                              "map_grid.yaml",
                                              "map_points.ply",
                                              "predictions.csv",
                                              "recordings.json",
                                              "replay.html",
                                              "replay.json",
                                              "report.html",
                                              "scene.3Dscene",
                                              "summary.json",
                                              "tracks.csv",
                                              "tracks.geojson",
                                              "tracks_kitti.txt",
                                              "tracks_smoothed.csv",
                                              "trajectory.geojson",
                                              "trajectory.tum",
                                              "trajectory_covariance.csv",
                                              "trajectory_kitti.txt",
                                              "trajectory_online.tum"};
  return names;
}

/// NNNNNN.png, of six or more digits.
bool isSnapshot(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  return file.extension() == ".png" && name.size() >= 6 &&
         name.find_first_not_of("0123456789") == std::string::npos;
}

}  // namespace

bool isResult(const std::filesystem::path& file) {
  if (file.parent_path() == "snapshots") return isSnapshot(file);
  return resultNames().count(file.string()) > 0;
}

}  // namespace headway::replay
