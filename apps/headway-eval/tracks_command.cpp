#include <headway/core/error.h>
#include <headway/eval/json.h>
#include <headway/eval/text_table.h>
#include <headway/eval/track_error.h>
#include <headway/eval/track_plot.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"
#include "label_files.h"
#include "outputs.h"

namespace headway::app {
namespace {

struct Options {
  std::string truth;
  std::string estimate;
  std::string metric = "3d";
  std::string classes = "Car,Pedestrian,Cyclist";
  std::optional<double> min_overlap;
  bool quiet = false;
  Outputs outputs;
};

/// What was read, and what was not.
struct Input {
  std::vector<eval::LabelledSequence> sequences;
  std::vector<std::string> truth_alone;
  std::map<std::string, std::size_t> dropped;
};

std::vector<ObjectClass> chosenClasses(const std::string& list) {
  std::vector<ObjectClass> classes;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    const auto object_class = objectClassFrom(word);
    if (!object_class)
      throw program::UsageError("--classes: '" + word + "' is no class of KITTI's");
    classes.push_back(*object_class);
  }
  if (classes.empty()) throw program::UsageError("--classes: names no class");
  return classes;
}

eval::TrackErrorParams paramsFrom(const Options& options) {
  eval::TrackErrorParams params;
  params.classes = chosenClasses(options.classes);
  if (options.metric == "2d") {
    params.metric = eval::BoxMetric::k2d;
    params.min_overlap = 0.5;
  } else if (options.metric != "3d") {
    throw program::UsageError("--metric: '" + options.metric + "' is neither 2d nor 3d");
  }
  if (options.min_overlap) params.min_overlap = *options.min_overlap;
  if (!(params.min_overlap > 0.0 && params.min_overlap <= 1.0)) {
    throw program::UsageError("--iou must be above 0 and at most 1");
  }
  return params;
}

bool parse(Options& options, int argc, const char** argv) {
  program::CommandLine line("headway-eval tracks",
                            "Compares tracks with labels: positions, CLEAR MOT, HOTA, sAMOTA.");
  double overlap = -1.0;
  line.option(options.truth, 0, "truth", "LABELS", "KITTI tracking labels: a file or a folder",
              true);
  line.option(options.estimate, 0, "estimate", "TRACKS",
              "KITTI tracking results: a file, or a folder with files of the labels' names", true);
  line.option(options.metric, 0, "metric", "2d|3d", "Boxes to compare; default 3d");
  line.option(overlap, 0, "iou", "X", "Overlap that makes a match; default 0.25 (3d), 0.5 (2d)");
  line.option(options.classes, 0, "classes", "Car,...", "Default Car,Pedestrian,Cyclist");
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  if (overlap != -1.0) options.min_overlap = overlap;
  options.quiet = line.quiet();
  options.outputs.requireWritable();
  return true;
}

Input readInput(const Options& options) {
  const auto files = pairedFiles(options.truth, options.estimate);
  Input input{{}, files.truth_alone, {}};
  for (const auto& [name, truth, estimate] : files.pairs) {
    eval::LabelledSequence sequence{name, readLabels(truth)};
    addEstimates(estimate, sequence.frames, input.dropped);
    input.sequences.push_back(std::move(sequence));
  }
  return input;
}

void requireBoxes(const Input& input, const Options& options) {
  for (const auto& sequence : input.sequences) {
    for (const auto& frame : sequence.frames) {
      for (const auto& box : frame.estimates) {
        if (options.metric == "2d" ? box.box2d.has_value() : box.box3d.has_value()) return;
      }
    }
  }
  throw InputError(options.estimate + ": holds no " + options.metric +
                   " boxes; is it a file of tracks, and --metric right?");
}

nlohmann::ordered_json figures(const Input& input, const eval::TrackErrors& errors,
                               const eval::TrackErrorParams& params) {
  auto json = eval::toJson(errors);
  for (const auto& sequence : input.sequences) {
    json["sequences"][sequence.name] = eval::toJson(eval::trackErrors({sequence}, params));
  }
  json["sequences_without_estimate"] = input.truth_alone;
  json["rows_dropped"] = input.dropped;
  return json;
}

void report(const Input& input, const eval::TrackErrors& errors) {
  eval::writeTable(std::cout, eval::tableOf(errors));
  if (!input.truth_alone.empty()) {
    std::cout << input.truth_alone.size() << " label files have no estimate and were left out:";
    for (const auto& name : input.truth_alone) std::cout << " " << name;
    std::cout << "\n";
  }
  for (const auto& [reason, count] : input.dropped) {
    std::cout << count << " rows of the estimate were left out: " << reason << "\n";
  }
}

}  // namespace

int runTracks(int argc, const char** argv) {
  Options options;
  if (!parse(options, argc, argv)) return program::kDone;
  const auto params = paramsFrom(options);
  const auto input = readInput(options);
  requireBoxes(input, options);
  const auto errors = eval::trackErrors(input.sequences, params);
  if (!options.quiet) report(input, errors);
  options.outputs.write([&] { return figures(input, errors, params); },
                        [&] { return eval::trackPlot(errors); });
  return program::kDone;
}

}  // namespace headway::app
