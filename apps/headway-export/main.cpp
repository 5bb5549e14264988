// SPDX-License-Identifier: BSD-3-Clause
// headway-export: converts rawlogs and replays for other programs.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/rawlog_source.h>
#include <headway/program/command_line.h>
#include <headway/program/output_folder.h>
#include <headway/program/progress.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <map>

#include "kitti_writer.h"
#include "map_command.h"
#include "replay_commands.h"

namespace headway::exporting {
namespace {

constexpr double kSameTime = 1e-3;  // truth and image of one frame [s]

struct ExportOptions {
  std::string input;
  std::string output;
  bool overwrite = false;
  bool quiet = false;
  io::RawlogSourceOptions source;
};

/// Returns false if the program is done (--help and similar).
bool parse(int argc, const char** argv, ExportOptions& options) {
  std::optional<std::size_t> from_index;
  Params none;
  program::CommandLine line("headway-export kitti-odometry",
                            "Writes a rawlog's rectified stereo frames as a KITTI odometry "
                            "sequence.");
  line.positional(options.input, "IN.rawlog", "Rawlog to read");
  line.option(options.output, 'o', "output", "DIR", "Folder to write", true);
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing folder");
  line.option(options.source.sensor_label, 0, "sensor-label", "LABEL",
              "Stereo camera to use if the rawlog contains several");
  line.option(from_index, 0, "from-index", "N", "Index of the first frame");
  line.option(options.source.to_index, 0, "to-index", "N", "Index of the last frame");
  line.parameters(none);
  if (!line.parse(argc, argv)) return false;
  options.source.from_index = from_index.value_or(0);
  options.quiet = line.quiet();
  return true;
}

/// The true pose of each frame; empty if a frame has none.
std::vector<Pose> truthAt(const std::vector<Time>& times, const std::string& rawlog) {
  const auto truth = io::readTruth(rawlog).poses;
  std::vector<Pose> poses;
  for (const Time time : times) {
    const auto found = std::find_if(truth.begin(), truth.end(), [time](const auto& pose) {
      return std::abs(pose.time - time) < kSameTime;
    });
    if (found == truth.end()) return {};
    poses.push_back(found->value);
  }
  return poses;
}

void report(const ExportOptions& options, const KittiWriter& writer, const io::RawlogSource& source,
            bool has_truth) {
  std::cout << options.output << ": " << writer.size() << " frames, "
            << (has_truth ? "with" : "without") << " poses.txt"
            << (program::interrupted() ? ", interrupted" : "");
  for (const auto& [reason, count] : source.skipped()) {
    std::cout << ", skipped " << printable(reason) << " " << count;
  }
  std::cout << std::endl;
}

int runExport(int argc, const char** argv) {
  ExportOptions options;
  if (!parse(argc, argv, options)) return program::kDone;
  program::catchInterrupts();
  io::RawlogSource source(options.input, options.source);
  if (!source.camera()) throw InputError(options.input + ": contains no stereo images");
  if (source.camera()->isDepthCamera()) {
    throw InputError(options.input +
                     ": is the recording of a depth camera; KITTI's layout consists "
                     "of the images of two cameras");
  }
  program::requireWritable(options.output, options.overwrite);
  program::OutputFolder folder(options.output, options.overwrite, {options.input}, isExported);
  KittiWriter writer(folder.path());
  std::vector<Time> times;
  {
    program::Progress progress("frames", options.quiet);
    while (!program::interrupted()) {
      const auto frame = source.next();
      if (!frame) break;
      writer.write(*frame->stereo, source.rightColour());
      times.push_back(frame->time);
      progress.update(times.size(), source.progress());
    }
  }
  writer.finish(*source.camera());
  const auto truth = truthAt(times, options.input);
  if (!truth.empty()) writer.writeTruth(truth, *source.camera());
  folder.publish();
  if (source.truncation()) {
    std::cerr << "headway-export: " << printable(*source.truncation()) << std::endl;
  }
  if (!options.quiet) report(options, writer, source, !truth.empty());
  return program::kDone;
}

}  // namespace
}  // namespace headway::exporting

int main(int argc, char** argv) {
  using namespace headway::exporting;
  using Command = int (*)(int, const char**);
  const std::map<std::string, Command> commands = {
      {"kitti-odometry", runExport}, {"map", runMapExport},        {"mcap", runMcapExport},
      {"tum", runTumExport},         {"kitti", runKittiExport},    {"ply", runPlyExport},
      {"rosmap", runRosmapExport},   {"geojson", runGeojsonExport}};
  return headway::program::run("headway-export", [&] {
    auto arguments = const_cast<const char**>(argv);
    const auto chosen = headway::program::takeSubcommand(
        argc, arguments, "Converts rawlogs, replays and maps for other systems.",
        {{"kitti-odometry", "Writes a KITTI odometry sequence of rectified stereo frames"},
         {"map", "Writes a part of a map"},
         {"mcap", "Writes a replay for Foxglove"},
         {"tum", "Writes the trajectory of a replay as TUM"},
         {"kitti", "Writes the trajectory and tracks of a replay as KITTI"},
         {"ply", "Writes the points of a replay's map as PLY"},
         {"rosmap", "Writes the grid of a replay for map servers"},
         {"geojson", "Writes a replay that is placed on the earth as GeoJSON"}});
    return commands.at(chosen)(argc, arguments);
  });
}
