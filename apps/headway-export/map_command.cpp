// SPDX-License-Identifier: BSD-3-Clause
#include "map_command.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/map/map_crop.h>
#include <headway/map/map_export.h>
#include <headway/program/command_line.h>
#include <headway/program/output_folder.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <set>
#include <vector>

namespace headway::exporting {
namespace {

namespace fs = std::filesystem;

struct MapExportOptions {
  std::string input;
  std::string output;
  std::string crop;
  bool overwrite = false;
  bool quiet = false;
};

bool parse(int argc, const char** argv, MapExportOptions& options) {
  Params none;
  program::CommandLine line("headway-export map",
                            "Writes the map of a replay in the formats of other programs, whole or "
                            "cut to a box.");
  line.positional(options.input, "OUTDIR|MAPFILE", "Folder of a replay, or its map.headway");
  line.option(options.output, 'o', "output", "DIR", "Folder to write", true);
  line.option(options.crop, 0, "crop", "X0,X1,Y0,Y1[,Z0,Z1]",
              "Box in the map frame to cut the map to, in metres");
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing folder");
  line.parameters(none);
  if (!line.parse(argc, argv)) return false;
  options.quiet = line.quiet();
  return true;
}

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
  constexpr double kUnlimited = std::numeric_limits<double>::infinity();
  if (values.size() == 4) values.insert(values.end(), {-kUnlimited, kUnlimited});
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

}  // namespace

int runMapExport(int argc, const char** argv) {
  MapExportOptions options;
  if (!parse(argc, argv, options)) return program::kDone;
  std::optional<Eigen::AlignedBox3d> box;
  if (!options.crop.empty()) box = boxFrom(options.crop);
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

}  // namespace headway::exporting
