// SPDX-License-Identifier: BSD-3-Clause
// headway-replay: stereo rawlog to trajectory, tracks, predictions, map and pictures.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/detect/network_detector.h>
#include <headway/pipeline/perception_params.h>
#include <headway/program/command_line.h>
#include <headway/program/progress.h>
#include <headway/scene/snapshot.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <string>
#include <vector>

#include "check_frame.h"
#include "recordings.h"
#include "replay.h"

namespace headway::replay {
namespace {

using program::CommandLine;
using program::UsageError;

constexpr int kTimedRuns = 5;

StereoFrame bundledFrame() {
  const std::vector<unsigned char> bytes(std::begin(kCheckFrame), std::end(kCheckFrame));
  auto camera = std::make_shared<StereoCamera>();
  StereoFrame frame;
  frame.left_colour = cv::imdecode(bytes, cv::IMREAD_COLOR);
  cv::cvtColor(frame.left_colour, frame.left, cv::COLOR_BGR2GRAY);
  camera->width = frame.left.cols;
  camera->height = frame.left.rows;
  frame.camera = camera;
  return frame;
}

double bestTime(detect::Detector& detector, const StereoFrame& frame) {
  double best_ms = 1e9;
  for (int run = 0; run < kTimedRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    (void)detector.detect(frame);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    best_ms = std::min(best_ms, elapsed.count());
  }
  return best_ms;
}

/// Runs a network on a bundled frame of a simulated street and prints its file, SHA-256, classes,
/// detections and time per frame.
///
/// @param file    of the model; empty: does nothing
/// @param params  of section [dnn]
/// @return        whether a model was checked
/// @throws InputError if the model cannot be used, or does not detect both a car and a pedestrian
///         in the frame, which shows several of each
bool checkModel(const std::string& file, detect::NetworkParams params) {
  if (file.empty()) return false;
  params.model = file;
  detect::NetworkDetector detector(params);
  const auto frame = bundledFrame();
  const auto found = detector.detect(frame);
  const auto shown = printable(detector.model());
  std::printf("model: %s\nSHA-256: %s\nclasses: %s\n", shown.c_str(),
              detect::sha256OfFile(detector.model()).c_str(), printable(params.classes).c_str());
  std::printf("frame: %d x %d px, in %.0f ms (best of %d)\n", frame.left.cols, frame.left.rows,
              bestTime(detector, frame), kTimedRuns);
  std::map<ObjectClass, int> counts;
  for (const auto& item : found.items) {
    ++counts[item.object_class];
    std::printf("%-12s score %.2f  %4.0f,%4.0f to %4.0f,%4.0f px\n",
                std::string(toString(item.object_class)).c_str(), item.score, item.box2d->left,
                item.box2d->top, item.box2d->right, item.box2d->bottom);
  }
  if (counts[ObjectClass::kCar] == 0 || counts[ObjectClass::kPedestrian] == 0) {
    throw InputError(shown + ": detects " + std::to_string(counts[ObjectClass::kCar]) +
                     " cars and " + std::to_string(counts[ObjectClass::kPedestrian]) +
                     " pedestrians in a frame that shows several of each; check [dnn] scale, "
                     "swap_red_blue, letterbox and classes");
  }
  return true;
}

/// Adds the options to a command line.
void describe(Options& options, CommandLine& line) {
  line.option(options.inputs, 'i', "input", "IN.rawlog",
              "Rawlog to replay; repeatable: several recordings get one map, and a folder each");
  line.option(options.output, 'o', "output", "OUTDIR", "Folder for all results");
  line.option(options.detections, 0, "detections", "FILE",
              "Boxes per frame (KITTI or CSV) that replace the recorded ones");
  line.option(options.detector, 0, "detector", "NAME",
              "Source of boxes: auto, none, recorded (rawlog or --detections), stereo_motion, "
              "dnn, hog, or several joined by +; default: detect.detector of the configuration");
  line.option(options.check_model, 0, "check-model", "FILE",
              "Run this network on a bundled frame and print what it detects; no -i, no -o");
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

/// @throws UsageError if options are missing, invalid or contradict each other
void check(const Options& options) {
  if (!options.check_model.empty()) {
    if (options.inputs.empty() && options.output.empty()) return;
    throw UsageError("--check-model runs on a bundled frame: leave out -i and -o");
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
  if (!options.truth.empty() &&
      !std::filesystem::is_regular_file(std::filesystem::path(options.truth) / "trajectory.tum")) {
    throw InputError(options.truth + ": --truth requires a folder with trajectory.tum");
  }
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
  for (const auto& picture : replay.pictures()) std::printf("picture: %s\n", picture.c_str());
  std::printf("report: %s/report.html\n", options.output.c_str());
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
  const auto& network = perception_params.detection.detect.network;
  if (replay::checkModel(options.check_model, network)) return program::kDone;
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
