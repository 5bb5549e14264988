// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/plots.h>
#include <headway/eval/track_error.h>
#include <headway/plot/chart.h>
#include <headway/plot/text_table.h>

#include <algorithm>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "commands.h"

namespace headway::app {
namespace {

using eval::TrackEvaluation;

struct TracksOptions {
  std::string truth;
  std::string estimate;
  std::string metric = "3d";
  std::string classes = "Car,Pedestrian,Cyclist";
  std::string raw;
  std::string poses;
  std::optional<double> min_overlap;
  bool quiet = false;
  Outputs outputs;
};

std::vector<ObjectClass> chosenClasses(const std::string& list) {
  std::vector<ObjectClass> classes;
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    const auto object_class = objectClassFrom(word);
    if (!object_class) throw program::UsageError("--classes: '" + word + "' is not a KITTI class");
    classes.push_back(*object_class);
  }
  if (classes.empty()) throw program::UsageError("--classes: the list is empty");
  return classes;
}

eval::TrackErrorParams paramsFrom(const TracksOptions& options) {
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

bool parseTracks(TracksOptions& options, int argc, const char** argv) {
  program::CommandLine line("headway-eval tracks",
                            "Evaluates tracks against labels: positions, CLEAR MOT, HOTA, sAMOTA.");
  double overlap = -1.0;
  line.option(options.truth, 0, "truth", "LABELS",
              "KITTI tracking labels, or the objects.csv of a simulation: a file or a folder",
              true);
  line.option(options.estimate, 0, "estimate", "TRACKS",
              "KITTI tracking results, or a tracks.csv: a file, or a folder with files of the same "
              "names",
              true);
  line.option(options.metric, 0, "metric", "2d|3d", "Compare 2D or 3D boxes; default 3d");
  line.option(overlap, 0, "iou", "X", "Minimum overlap of a match; default 0.25 (3d), 0.5 (2d)");
  line.option(options.classes, 0, "classes", "Car,...",
              "Classes to evaluate; default Car,Pedestrian,Cyclist");
  line.option(options.raw, 0, "raw", "DETECTIONS",
              "Also evaluate the positions of raw detections: file, rawlog or folder");
  line.option(options.poses, 0, "poses", "P",
              "Pose of every frame (KITTI or TUM): --plot then includes a map");
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  if (overlap != -1.0) options.min_overlap = overlap;
  options.quiet = line.quiet();
  options.outputs.requireWritable({options.truth, options.estimate});
  return true;
}

void report(const TrackEvaluation& results) {
  plot::writeTable(std::cout, eval::tableOf(results.tracks));
  if (results.raw) {
    std::cout << "\nPositions, raw detections / tracks\n\n";
    plot::writeTable(std::cout, eval::positionTable(*results.raw, results.tracks));
  }
  if (!results.truth_alone.empty()) {
    std::cout << results.truth_alone.size() << " label files have no estimate and were ignored:";
    for (const auto& name : results.truth_alone) std::cout << " " << name;
    std::cout << "\n";
  }
  for (const auto& [reason, count] : results.dropped) {
    std::cout << count << " rows of the estimate were ignored: " << reason << "\n";
  }
}

/// Map of the sequence with the most labels.
cv::Mat mapPlot(const TracksOptions& options, const TrackEvaluation& results) {
  const auto boxes = [](const eval::LabelledSequence& sequence) {
    std::size_t count = 0;
    for (const auto& frame : sequence.frames) count += frame.truth.size();
    return count;
  };
  const auto sequence =
      std::max_element(results.sequences.begin(), results.sequences.end(),
                       [&](const auto& a, const auto& b) { return boxes(a) < boxes(b); });
  const auto T_map_cam =
      eval::readCameraPoses(eval::fileNamed(sequence->name, options.poses), robotFromOptical());
  eval::TrackMap map{recordingName(eval::fileNamed(sequence->name, options.estimate)) + ": tracks",
                     eval::trueObjects(sequence->frames, T_map_cam),
                     eval::estimatedObjects(sequence->frames, T_map_cam),
                     {},
                     {}};
  if (!results.raw_sequences.empty()) {
    const auto index = static_cast<std::size_t>(sequence - results.sequences.begin());
    map.raw = eval::estimatedObjects(results.raw_sequences[index].frames, T_map_cam);
  }
  for (const auto& pose : T_map_cam) {
    map.camera_path.emplace_back(pose.value.translation().head<2>());
  }
  return eval::trackMapPlot(map);
}

cv::Mat plot(const TracksOptions& options, const TrackEvaluation& results) {
  const cv::Mat curves =
      eval::trackPlot(recordingName(options.estimate) + ": accuracy over recall", results.tracks);
  return options.poses.empty() ? curves : plot::stacked({mapPlot(options, results), curves});
}

}  // namespace

int runTracks(int argc, const char** argv) {
  TracksOptions options;
  if (!parseTracks(options, argc, argv)) return program::kDone;
  const auto results =
      eval::evaluateTracks({options.truth, options.estimate, options.raw}, paramsFrom(options));
  if (!options.quiet) report(results);
  options.outputs.write([&] { return toJson(results); }, [&] { return plot(options, results); });
  return program::kDone;
}

}  // namespace headway::app
