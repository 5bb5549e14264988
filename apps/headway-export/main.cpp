// SPDX-License-Identifier: BSD-3-Clause
// headway-export: converts rawlogs and replays for other programs.
#include "commands.h"

namespace headway::exporting {

bool parse(int argc, const char** argv, const ExportText& text, ExportOptions& options,
           const std::function<void(program::CommandLine&)>& more) {
  const std::string kind = text.is_folder ? "folder" : "file";
  program::CommandLine line("headway-export " + text.command, text.summary);
  Params none;
  line.positional(options.input, text.input_type, text.input);
  line.option(options.output, 'o', "output", text.output_type,
              (text.is_folder ? "Folder" : "File") + std::string(" to write"), true);
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing " + kind);
  if (more) more(line);
  line.parameters(none);
  if (!line.parse(argc, argv)) return false;
  options.quiet = line.quiet();
  return true;
}

}  // namespace headway::exporting

int main(int argc, char** argv) {
  using namespace headway::exporting;
  return headway::program::run("headway-export", [&] {
    return headway::program::runSubcommand(
        argc, const_cast<const char**>(argv),
        "Converts rawlogs, replays and maps for other systems.",
        {{"kitti-odometry", "Writes a KITTI odometry sequence of rectified stereo frames",
          runKittiOdometryExport},
         {"map", "Writes the map of a replay, whole or cut to a box", runMapExport},
         {"mcap", "Writes a replay for Foxglove", runMcapExport},
         {"tum", "Writes the trajectory of a replay as TUM", runTumExport},
         {"kitti", "Writes the trajectory or the tracks of a replay as KITTI", runKittiExport},
         {"ply", "Writes the points of a replay's map as PLY", runPlyExport},
         {"rosmap", "Writes the grid of a replay for map servers", runRosmapExport},
         {"geojson", "Writes a replay that is placed on the earth as GeoJSON", runGeojsonExport}});
  });
}
