// SPDX-License-Identifier: BSD-3-Clause
// headway-import rosbag: topics of a bag of ROS, and its conversion to a rawlog.
#include <headway/bags/bag_import.h>
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>

#include <algorithm>
#include <iostream>

#include "commands.h"
#include "recording_check.h"

namespace headway::import {
namespace {

struct RosbagOptions {
  std::string bag;
  bool list = false;
  bags::BagWishes wishes;
  bags::BagImportOptions import;
  std::optional<std::size_t> from_index;
  std::string output;
  bool check = false;
  bool overwrite = false;
  bool external_images = false;
  bool quiet = false;
};

void addTopics(program::CommandLine& line, bags::BagWishes& wishes) {
  line.option(wishes.left, 0, "left", "TOPIC", "Left images of a stereo camera");
  line.option(wishes.right, 0, "right", "TOPIC", "Right images");
  line.option(wishes.color, 0, "color", "TOPIC", "Colour images of a depth camera");
  line.option(wishes.depth, 0, "depth", "TOPIC", "Depth images");
  line.option(wishes.imu, 0, "imu", "TOPIC[,TOPIC]|none", "Inertial samples");
  line.option(wishes.odometry, 0, "odom", "TOPIC|none", "Wheel odometry");
  line.option(wishes.scan, 0, "scan", "TOPIC[,TOPIC]|none", "2D laser scans");
  line.option(wishes.gnss, 0, "gps", "TOPIC|none", "Satellite positions");
  line.option(wishes.tf, 0, "tf", "TOPIC[,TOPIC]|none", "Transforms, for mounting");
}

std::optional<RosbagOptions> parseRosbag(int argc, const char** argv) {
  RosbagOptions options;
  program::CommandLine line("headway-import rosbag",
                            "Converts a bag of ROS 1 (.bag) or ROS 2 (.mcap, .db3, or its folder) "
                            "to a rawlog; topics that are not given are guessed.");
  line.positional(options.bag, "BAG", "Bag, or folder of a ROS 2 bag");
  line.flag(options.list, 0, "list", "List the topics and which would be used; write nothing");
  addTopics(line, options.wishes);
  line.option(options.import.base_frame, 0, "base", "FRAME",
              "Frame of the robot (default: base_link, base_footprint, base or body)");
  line.option(options.import.calibration, 0, "calibration", "FILE",
              "Calibration of the stereo camera instead of camera_info (doc/formats.md)");
  line.option(options.output, 'o', "output", "OUT.rawlog", "Rawlog to write");
  addCheck(line, options.check);
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing output");
  line.option(options.from_index, 0, "from-index", "N", "Index of the first frame");
  line.option(options.import.last_frame, 0, "to-index", "N", "Index of the last frame");
  line.flag(options.external_images, 0, "external-images",
            "Store images of a stereo camera as PNG files in NAME_Images/");
  if (!line.parse(argc, argv)) return std::nullopt;
  options.quiet = line.quiet();
  options.import.first_frame = options.from_index.value_or(0);
  if (!options.list && !options.check && options.output.empty()) {
    throw program::UsageError("give -o OUT.rawlog, --check or --list");
  }
  return options;
}

/// One row per topic.
void printTopics(std::ostream& out, const std::vector<bags::BagTopic>& topics,
                 const std::optional<bags::BagSelection>& selection, bool only_used) {
  for (const auto& topic : topics) {
    const std::string use = selection ? bags::useOf(topic, *selection) : "";
    if (only_used && use.empty()) continue;
    out << printable(topic.name) << "  " << printable(topic.type) << "  " << topic.messages;
    if (!use.empty()) out << "  -> " << use;
    if (topic.encoding == bags::Encoding::kOther) out << "  (of an encoding that is not read)";
    out << "\n";
  }
}

int listTopics(const RosbagOptions& options) {
  const auto bag = bags::openBag(options.bag);
  std::optional<bags::BagSelection> selection;
  std::string problem;
  try {
    selection = bags::selectTopics(bag->topics(), options.wishes);
  } catch (const InputError& error) {
    problem = error.what();
  }
  printTopics(std::cout, bag->topics(), selection, false);
  if (!problem.empty()) std::cout << printable(problem) << std::endl;
  return program::kDone;
}

void reportImport(const RosbagOptions& options, const bags::BagImportSummary& summary) {
  for (const auto& note : summary.notes) std::cout << "note: " << printable(note) << "\n";
  if (summary.truncation) {
    std::cout << "note: " << printable(options.bag + " " + *summary.truncation) << "\n";
  }
  std::cout << printable(options.output) << ": " << summary.frames << " frames";
  for (const auto& [kind, count] : summary.written) std::cout << ", " << count << " " << kind;
  if (summary.was_stopped) std::cout << ", interrupted";
  for (const auto& [reason, count] : summary.dropped) {
    std::cout << ", skipped " << printable(reason) << " " << count;
  }
  std::cout << std::endl;
}

}  // namespace

int runRosbag(int argc, const char** argv) {
  auto options = parseRosbag(argc, argv);
  if (!options) return program::kDone;
  if (options->list) return listTopics(*options);
  const ImportOutput output(options->output, options->check);
  options->output = output.path();
  program::registerDataset(options->bag);
  program::requireWritable(options->output, options->overwrite,
                           {options->bag, options->import.calibration});
  {
    const auto bag = bags::openBag(options->bag);
    options->import.topics = bags::selectTopics(bag->topics(), options->wishes);
    if (!options->quiet) printTopics(std::cout, bag->topics(), options->import.topics, true);
  }
  program::catchInterrupts();
  io::RawlogSink sink(options->output, options->external_images ? io::ImageStorage::kExternalPng
                                                                : io::ImageStorage::kEmbeddedRaw);
  program::Progress progress("frames", options->quiet);
  const auto summary =
      bags::importBag(options->bag, options->import, sink, [&](std::size_t frames, double ratio) {
        progress.update(frames, ratio);
        return !program::interrupted();
      });
  sink.close();
  progress.finish();
  if (!options->quiet) reportImport(*options, summary);
  return options->check ? checkRawlog(options->output) : program::kDone;
}

}  // namespace headway::import
