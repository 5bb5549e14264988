// SPDX-License-Identifier: BSD-3-Clause
// headway-export map, tum, kitti, ply, rosmap, geojson: results of a replay in formats of others.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/core/text.h>
#include <headway/io/calibration_file.h>
#include <headway/io/image_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/map_crop.h>
#include <headway/map/map_export.h>
#include <headway/program/files.h>
#include <headway/program/picture_files.h>
#include <headway/report/map_files.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "commands.h"

namespace headway::exporting {
namespace {

namespace fs = std::filesystem;

/// Box of "x0,x1,y0,y1" or "x0,x1,y0,y1,z0,z1".
Eigen::AlignedBox3d boxFrom(const std::string& text) {
  const auto refuse = [&text] {
    return program::UsageError("--crop " + text +
                               ": must be X0,X1,Y0,Y1 or X0,X1,Y0,Y1,Z0,Z1 in metres, each first "
                               "number less than the second");
  };
  std::vector<double> values;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at < end) {
    double value = 0.0;
    const auto [rest, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value)) throw refuse();
    values.push_back(value);
    if (rest < end && (*rest != ',' || rest + 1 == end)) throw refuse();
    at = rest < end ? rest + 1 : rest;
  }
  if (values.size() == 4) values.insert(values.end(), {-INFINITY, INFINITY});
  if (values.size() != 6) throw refuse();
  for (std::size_t i = 0; i < values.size(); i += 2) {
    if (!(values[i] < values[i + 1])) throw refuse();
  }
  return {Eigen::Vector3d(values[0], values[2], values[4]),
          Eigen::Vector3d(values[1], values[3], values[5])};
}

bool isMapFile(const fs::path& file) {
  static const std::set<std::string> names = {"map.headway",    "map.simplemap",
                                              "map_points.ply", "map_grid.gridmap.gz",
                                              "map_grid.png",   "map_grid.yaml"};
  return names.count(file.string()) > 0;
}

/// Reads the command line of a command that writes one file of a replay.
bool parseFiles(int argc, const char** argv, const std::string& command, const std::string& summary,
                const std::string& output_type, ExportOptions& options,
                const std::function<void(program::CommandLine&)>& more = {}) {
  return parse(argc, argv, {command, summary, "OUTDIR", "Folder of a finished replay", output_type},
               options, more);
}

/// @throws InputError naming the file and what it is of, if there is none
fs::path required(const ExportOptions& options, const std::string& name, const std::string& cause) {
  const fs::path path = fs::path(options.input) / name;
  if (fs::exists(path)) return path;
  throw InputError(path.string() + ": no such file; " + cause);
}

constexpr char kNoReplay[] = "is the folder that of a finished replay?";

void write(const ExportOptions& options, std::string_view bytes, const std::string& what) {
  program::requireWritable(options.output, options.overwrite);
  writeFile(options.output, bytes);
  if (!options.quiet) std::cout << printable(options.output + ": " + what) << std::endl;
}

/// A FeatureCollection's features. @throws InputError if the file is none
nlohmann::ordered_json featuresOf(const fs::path& path) {
  const auto json = nlohmann::ordered_json::parse(program::readFile(path), nullptr, false);
  const bool is_collection =
      json.is_object() && json.contains("features") && json["features"].is_array();
  if (!is_collection) throw InputError(path.string() + ": is not a GeoJSON FeatureCollection");
  return json["features"];
}

}  // namespace

int runMapExport(int argc, const char** argv) {
  ExportOptions options;
  std::string crop;
  const auto more = [&](program::CommandLine& line) {
    line.option(crop, 0, "crop", "X0,X1,Y0,Y1[,Z0,Z1]",
                "Box in the map frame to cut the map to, in metres");
  };
  if (!parse(argc, argv,
             {"map",
              "Writes the map of a replay in the formats of other programs, whole or cut to a box.",
              "OUTDIR|MAPFILE", "Folder of a replay, or its map.headway", "DIR", true},
             options, more)) {
    return program::kDone;
  }
  std::optional<Eigen::AlignedBox3d> box;
  if (!crop.empty()) box = boxFrom(crop);
  fs::path file = options.input;
  if (fs::is_directory(file)) file /= "map.headway";
  map::StoredMap stored = map::loadMap(file.string());
  if (box) {
    try {
      stored = map::cropped(stored, *box);
    } catch (const InputError& error) {
      throw InputError(file.string() + ": " + error.what());
    }
  }
  program::OutputFolder folder(options.output, options.overwrite, {file.string()}, isMapFile);
  const auto keyframes = stored.map.staticMap()->keyframes.size();
  const auto landmarks = stored.map.staticMap()->landmarks.size();
  map::writeMapFiles(folder.path(), std::move(stored));
  folder.publish();
  if (!options.quiet) {
    std::cout << printable(options.output) << ": " << keyframes << " keyframes, " << landmarks
              << " landmarks" << std::endl;
  }
  return program::kDone;
}

int runTumExport(int argc, const char** argv) {
  ExportOptions options;
  bool online = false;
  const auto more = [&](program::CommandLine& line) {
    line.flag(online, 0, "online", "The poses as published at each frame, not the final ones");
  };
  if (!parseFiles(argc, argv, "tum", "Writes the path as TUM poses: t x y z qx qy qz qw.", "X.tum",
                  options, more)) {
    return program::kDone;
  }
  const auto path =
      required(options, online ? "trajectory_online.tum" : "trajectory.tum", kNoReplay);
  const auto poses = io::readTum(path);
  write(options, program::readFile(path), std::to_string(poses.size()) + " poses");
  return program::kDone;
}

int runKittiExport(int argc, const char** argv) {
  ExportOptions options;
  bool tracks = false;
  const auto more = [&](program::CommandLine& line) {
    line.flag(tracks, 0, "tracks", "The tracks as KITTI tracking results instead of the poses");
  };
  if (!parseFiles(argc, argv, "kitti",
                  "Writes the path of the left camera as KITTI poses, one row a frame, or the "
                  "tracks as KITTI tracking results.",
                  "X.txt", options, more)) {
    return program::kDone;
  }
  const auto path =
      required(options, tracks ? "tracks_kitti.txt" : "trajectory_kitti.txt", kNoReplay);
  const std::string rows = program::readFile(path);
  write(options, rows, std::to_string(std::count(rows.begin(), rows.end(), '\n')) + " rows");
  return program::kDone;
}

int runPlyExport(int argc, const char** argv) {
  ExportOptions options;
  std::string layer;
  const auto more = [&](program::CommandLine& line) {
    line.option(layer, 0, "layer", "dense|landmarks",
                "Part of the map; default: the dense map, or the landmarks if there is none");
  };
  if (!parseFiles(argc, argv, "ply", "Writes the map's points with their colours as a PLY file.",
                  "X.ply", options, more)) {
    return program::kDone;
  }
  if (!layer.empty() && layer != "dense" && layer != "landmarks") {
    throw program::UsageError("--layer: '" + layer + "' is neither dense nor landmarks");
  }
  const bool has_dense = fs::exists(fs::path(options.input) / "map_dense.ply");
  const bool dense = layer.empty() ? has_dense : layer == "dense";
  const auto path = required(options, dense ? "map_dense.ply" : "map_points.ply",
                             dense ? "the replay has made no dense map" : kNoReplay);
  const auto points = report::readPoints(path, 0);
  write(options, program::readFile(path), std::to_string(points.size()) + " points");
  return program::kDone;
}

int runRosmapExport(int argc, const char** argv) {
  ExportOptions options;
  if (!parseFiles(argc, argv, "rosmap",
                  "Writes the occupancy grid for a map server of ROS: X.yaml and X.pgm.", "X.yaml",
                  options)) {
    return program::kDone;
  }
  const fs::path output(options.output);
  if (output.extension() != ".yaml") {
    throw program::UsageError("--output: '" + options.output + "' must end in .yaml");
  }
  const fs::path picture = fs::path(output).replace_extension(".pgm");
  program::requireWritable(picture.string(), options.overwrite);
  const auto description = required(options, "map_grid.yaml", "the replay has made no grid");
  const auto grid = report::readGrid(description);
  const cv::Mat grey = io::loadGreyImage(grid->picture.string());
  if (grey.empty()) throw InputError(grid->picture.string() + ": is not a readable picture");
  program::requireWritable(options.output, options.overwrite);
  program::writePicture(picture.string(), grey);
  write(
      options,
      formatted("image: %s\nmode: trinary\nresolution: %g\norigin: [%.6g, %.6g, 0.0]\nnegate: 0\n"
                "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                picture.filename().c_str(), grid->resolution_m, grid->origin.x(), grid->origin.y()),
      formatted("%d x %d cells of %g m", grey.cols, grey.rows, grid->resolution_m));
  return program::kDone;
}

int runGeojsonExport(int argc, const char** argv) {
  ExportOptions options;
  if (!parseFiles(argc, argv, "geojson",
                  "Writes the path and the tracks on the earth as one GeoJSON FeatureCollection.",
                  "X.geojson", options)) {
    return program::kDone;
  }
  const auto path =
      required(options, "trajectory.geojson",
               "the replay had too few satellite fixes to place its map on the earth");
  auto features = featuresOf(path);
  const fs::path tracks = fs::path(options.input) / "tracks.geojson";
  if (fs::exists(tracks)) {
    for (auto& feature : featuresOf(tracks)) features.push_back(std::move(feature));
  }
  const std::size_t count = features.size();
  const nlohmann::ordered_json collection = {{"type", "FeatureCollection"}, {"features", features}};
  write(options, collection.dump() + "\n", std::to_string(count) + " features");
  return program::kDone;
}

}  // namespace headway::exporting
