// SPDX-License-Identifier: BSD-3-Clause
// The results of a replay that other programs read as one file each.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/core/text.h>
#include <headway/io/calibration_file.h>
#include <headway/io/image_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/command_line.h>
#include <headway/report/map_files.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "replay_commands.h"

namespace headway::exporting {
namespace {

namespace fs = std::filesystem;

/// Folder of the replay and file to write.
struct FileOptions {
  std::string folder;
  std::string output;
  bool overwrite = false;
  bool quiet = false;
};

/// Declares what all commands have; `more` declares the rest.
bool parseFiles(int argc, const char** argv, const std::string& command, const std::string& summary,
                const std::string& output_type, FileOptions& options,
                const std::function<void(program::CommandLine&)>& more = {}) {
  program::CommandLine line("headway-export " + command, summary);
  Params none;
  line.positional(options.folder, "OUTDIR", "Folder of a finished replay");
  line.option(options.output, 'o', "output", output_type, "File to write", true);
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing file");
  if (more) more(line);
  line.parameters(none);
  if (!line.parse(argc, argv)) return false;
  options.quiet = line.quiet();
  return true;
}

/// @throws InputError naming the file and what it is of, if there is none
fs::path required(const FileOptions& options, const std::string& name, const std::string& cause) {
  const fs::path path = fs::path(options.folder) / name;
  if (fs::exists(path)) return path;
  throw InputError(path.string() + ": no such file; " + cause);
}

constexpr char kNoReplay[] = "is the folder that of a finished replay?";

std::string contentsOf(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  if (!file) throw InputError(path.string() + ": cannot be read");
  return bytes.str();
}

void write(const FileOptions& options, std::string_view bytes, const std::string& what) {
  program::requireWritable(options.output, options.overwrite);
  writeFile(options.output, bytes);
  if (!options.quiet) std::cout << options.output << ": " << what << std::endl;
}

/// A FeatureCollection's features. @throws InputError if the file is none
nlohmann::ordered_json featuresOf(const fs::path& path) {
  const auto json = nlohmann::ordered_json::parse(contentsOf(path), nullptr, false);
  const bool is_collection =
      json.is_object() && json.contains("features") && json["features"].is_array();
  if (!is_collection) throw InputError(path.string() + ": is not a GeoJSON FeatureCollection");
  return json["features"];
}

}  // namespace

int runTumExport(int argc, const char** argv) {
  FileOptions options;
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
  write(options, contentsOf(path), std::to_string(poses.size()) + " poses");
  return program::kDone;
}

int runKittiExport(int argc, const char** argv) {
  FileOptions options;
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
  const std::string rows = contentsOf(path);
  write(options, rows, std::to_string(std::count(rows.begin(), rows.end(), '\n')) + " rows");
  return program::kDone;
}

int runPlyExport(int argc, const char** argv) {
  FileOptions options;
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
  const bool has_dense = fs::exists(fs::path(options.folder) / "map_dense.ply");
  const bool dense = layer.empty() ? has_dense : layer == "dense";
  const auto path = required(options, dense ? "map_dense.ply" : "map_points.ply",
                             dense ? "the replay has made no dense map" : kNoReplay);
  const auto points = report::readPoints(path, 0);
  write(options, contentsOf(path), std::to_string(points.size()) + " points");
  return program::kDone;
}

int runRosmapExport(int argc, const char** argv) {
  FileOptions options;
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
  std::vector<unsigned char> pgm;
  cv::imencode(".pgm", grey, pgm);
  program::requireWritable(options.output, options.overwrite);
  writeFile(picture, {reinterpret_cast<const char*>(pgm.data()), pgm.size()});
  write(
      options,
      formatted("image: %s\nmode: trinary\nresolution: %g\norigin: [%.6g, %.6g, 0.0]\nnegate: 0\n"
                "occupied_thresh: 0.65\nfree_thresh: 0.196\n",
                picture.filename().c_str(), grid->resolution_m, grid->origin.x(), grid->origin.y()),
      formatted("%d x %d cells of %g m", grey.cols, grey.rows, grid->resolution_m));
  return program::kDone;
}

int runGeojsonExport(int argc, const char** argv) {
  FileOptions options;
  if (!parseFiles(argc, argv, "geojson",
                  "Writes the path and the tracks on the earth as one GeoJSON FeatureCollection.",
                  "X.geojson", options)) {
    return program::kDone;
  }
  const auto path =
      required(options, "trajectory.geojson",
               "the replay had too few satellite fixes to place its map on the earth");
  auto features = featuresOf(path);
  const fs::path tracks = fs::path(options.folder) / "tracks.geojson";
  if (fs::exists(tracks)) {
    for (auto& feature : featuresOf(tracks)) features.push_back(std::move(feature));
  }
  const std::size_t count = features.size();
  const nlohmann::ordered_json collection = {{"type", "FeatureCollection"}, {"features", features}};
  write(options, collection.dump() + "\n", std::to_string(count) + " features");
  return program::kDone;
}

}  // namespace headway::exporting
