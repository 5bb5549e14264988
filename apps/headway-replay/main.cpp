// SPDX-License-Identifier: BSD-3-Clause
// headway-replay: stereo rawlog to trajectory, tracks, predictions, map and pictures.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/pipeline/perception_params.h>
#include <headway/program/command_line.h>
#include <headway/program/progress.h>
#include <headway/scene/snapshot.h>

#include <cstdio>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "model_files.h"
#include "recordings.h"
#include "replay.h"

namespace headway::replay {
namespace {

using program::CommandLine;
using program::UsageError;

/// Adds the options to a command line.
void describe(Options& options, CommandLine& line) {
  line.option(options.inputs, 'i', "input", "IN.rawlog",
              "Rawlog to replay; repeatable: several recordings get one map, and a folder each");
  line.option(options.output, 'o', "output", "OUTDIR", "Folder for all results");
  line.option(options.detections, 0, "detections", "FILE",
              "Boxes per frame (KITTI or CSV) that replace the recorded ones");
  line.option(
      options.detector, 0, "detector", "NAME",
      "Source of boxes: auto, none, recorded (rawlog or --detections), stereo_motion, "
      "dnn, hog, shape, or several joined by +; default: detect.detector of the configuration");
  line.option(options.check_model, 0, "check-model", "FILE",
              "Run this network on a bundled frame and print what it detects; no -i, no -o");
  line.option(options.get_model, 0, "get-model", "NAME",
              "Download this network (yolox_nano) by curl to where auto finds it; no -i, no -o");
  line.option(options.sensor_label, 0, "sensor-label", "LABEL",
              "Stereo camera to use if the rawlog contains several");
  line.option(options.load_map, 0, "load-map", "FILE",
              "Localise in this map.headway and extend it (slam.mapping=false: localise only)");
  line.option(options.realtime, 0, "realtime", "FACTOR",
              "Replay at FACTOR times the recorded rate, dropping late frames; 0: every frame");
  line.option(options.from_index, 0, "from-index", "N", "Index of the first stereo frame");
  line.option(options.to_index, 0, "to-index", "N", "Index of the last stereo frame");
  line.option(options.truth, 0, "truth", "DIR",
              "Folder with trajectory.tum and objects.csv to compare with in the report");
  line.option(options.snapshots, 0, "snapshots", "N",
              "Number of pictures of the map to draw; default 6");
  line.option(options.theme, 0, "theme", "dark|light",
              "Colours of the pictures and the scene; default dark");
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite the results in an existing folder");
}

/// Options that mean one recording.
void checkSeveral(const Options& options) {
  const auto refuse = [](bool is_given, const char* option, const char* reason) {
    if (!is_given) return;
    throw UsageError(std::string(option) +
                     ": takes one recording, and here are several: " + reason);
  };
  refuse(!options.detections.empty(), "--detections", "its frames are those of one recording");
  refuse(!options.truth.empty(), "--truth", "it belongs to one recording");
  refuse(options.from_index.has_value(), "--from-index", "frames are counted in each of them");
  refuse(options.to_index.has_value(), "--to-index", "frames are counted in each of them");
  refuse(!options.load_map.empty(), "--load-map",
         "give the recordings of the map as further -i, or replay one after the other");
  std::set<std::filesystem::path> files;
  for (const auto& input : options.inputs) {
    if (!files.insert(std::filesystem::weakly_canonical(input)).second) {
      throw UsageError("-i " + input + ": is given twice");
    }
  }
}

/// Reads what the pages compare, so that an error is found before hours of work.
void checkTruth(const std::filesystem::path& folder) {
  if (!std::filesystem::is_regular_file(folder / "trajectory.tum")) {
    throw InputError(folder.string() + ": --truth requires a folder with trajectory.tum");
  }
  (void)io::readTum(folder / "trajectory.tum");
  if (std::filesystem::exists(folder / "objects.csv")) {
    (void)io::readTrackCsv(folder / "objects.csv");
  }
}

/// @throws UsageError if options are missing, invalid or contradict each other
void check(const Options& options) {
  if (!options.check_model.empty() || !options.get_model.empty()) {
    if (options.inputs.empty() && options.output.empty()) return;
    throw UsageError(options.get_model.empty()
                         ? "--check-model runs on a bundled frame: leave out -i and -o"
                         : "--get-model downloads, and replays nothing: leave out -i and -o");
  }
  if (options.inputs.empty() || options.output.empty()) {
    throw UsageError(std::string(options.inputs.empty() ? "-i/--input" : "-o/--output") +
                     ": is required (--help shows the options)");
  }
  if (options.inputs.size() > 1) checkSeveral(options);
  if (!options.detector.empty()) {
    checkDetector(options.detector);
    if (!options.detections.empty() && !pipeline::usesRecordedBoxes(options.detector)) {
      throw UsageError("--detections has no effect with --detector " + options.detector);
    }
  }
  if (!options.truth.empty()) checkTruth(options.truth);
  if (!(options.realtime >= 0.0)) throw UsageError("--realtime must not be negative");
  if (!options.theme.empty() && !scene::themeFrom(options.theme)) {
    throw UsageError("--theme: '" + options.theme + "' is neither dark nor light");
  }
  if (options.from_index && options.to_index && *options.to_index < *options.from_index) {
    throw UsageError("--to-index is less than --from-index");
  }
}

void replayOne(const Options& options, const pipeline::PerceptionParams& perception_params,
               const Params& params) {
  replay::Replay replay(options, perception_params, params);
  replay.run();
  if (options.quiet) return;
  replay::printSummary(replay.summary());
  for (const auto& picture : replay.pictures())
    std::printf("picture: %s\n", printable(picture.string()).c_str());
  std::printf("report: %s/report.html\n", printable(options.output).c_str());
}

int runReplay(int argc, char** argv) {
  Options options;
  pipeline::PerceptionParams perception_params;
  Params params;
  perception_params.describe(params);
  replay::describeCheckpoints(options.checkpoint_s, params);

  CommandLine line(
      "headway-replay",
      "Processes a stereo rawlog: localises the camera, maps what stands still, tracks and "
      "predicts what moves, places the map on the earth by satellite fixes; results: OUTDIR.");
  describe(options, line);
  line.parameters(params);
  if (!line.parse(argc, argv)) return program::kDone;
  options.quiet = line.quiet() || line.verbosity() > mrpt::system::LVL_INFO;
  options.debug = line.verbosity() == mrpt::system::LVL_DEBUG;
  check(options);
  if (!options.get_model.empty()) getModel(options.get_model, options.quiet);
  if (!options.check_model.empty()) {
    checkModel(options.check_model, perception_params.detection.detect.network);
  }
  if (options.inputs.empty()) return program::kDone;
  if (!options.detector.empty()) perception_params.detection.detector = options.detector;

  program::catchInterrupts();
  if (options.inputs.size() > 1) {
    replay::Recordings(options, perception_params, params).run();
  } else {
    options.input = options.inputs.front();
    replayOne(options, perception_params, params);
  }
  return program::kDone;
}

}  // namespace
}  // namespace headway::replay

int main(int argc, char** argv) {
  return headway::program::run("headway-replay",
                               [&] { return headway::replay::runReplay(argc, argv); });
}
