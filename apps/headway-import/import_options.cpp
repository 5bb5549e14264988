// SPDX-License-Identifier: BSD-3-Clause
#include <headway/io/dataset.h>
#include <headway/program/command_line.h>
#include <headway/program/data_files.h>

#include "check_command.h"
#include "importer.h"

namespace headway::import {
namespace {

using program::CommandLine;

constexpr const char* kDefaultBoxes = "det3d_pointrcnn";

/// What a dataset's folder contains.
std::string folderDescription(const std::string& dataset) {
  if (dataset == "euroc") return "Folder that contains mav0/";
  if (dataset == "tum-rgbd") return "Folder that contains rgb.txt and depth.txt";
  if (dataset == "kitti-tracking") return "Folder that contains training/";
  if (dataset == "kitti-raw") return "Folder that contains the days, such as 2011_09_26/";
  return "Folder that contains sequences/";
}

void addOxtsPath(CommandLine& line, ImportOptions& options) {
  line.option(options.oxts_path, 0, "oxts-path", "positions|velocities",
              "True path: OXTS positions (default), or its velocities integrated");
}

void addDatasetOptions(CommandLine& line, ImportOptions& options) {
  if (options.dataset == "images") {
    line.option(options.left, 0, "left", "DIR", "Folder of left images", true);
    line.option(options.right, 0, "right", "DIR", "Folder of right images");
    line.option(options.depth, 0, "depth", "DIR", "Instead: folder of depth images, 16-bit PNG");
    line.option(options.calibration, 0, "calibration", "FILE",
                "Calibration of the pair: headway, MRPT, ROS, Kalibr, ORB-SLAM or OpenCV, two "
                "files separated by a comma; with --depth: headway (doc/formats.md)",
                true);
    return;
  }
  line.positional(options.folder, "DIR", folderDescription(options.dataset));
  if (options.dataset == "tum-rgbd") {
    line.option(options.calibration, 0, "calibration", "FILE",
                "Calibration of the depth camera (doc/formats.md); default: the published one of "
                "freiburg1, freiburg2 or freiburg3 in DIR's name");
    return;
  }
  if (options.dataset == "euroc") return;
  if (options.dataset == "kitti-raw") {
    line.option(options.drive, 0, "drive", "NAME", "Drive, such as 2011_09_26_drive_0005_sync",
                true);
    addOxtsPath(line, options);
    return;
  }
  line.option(options.sequence, 0, "sequence", "NAME", "Sequence, such as 06 or 0001", true);
  if (options.dataset != "kitti-tracking") return;
  line.option(options.boxes, 0, "boxes", "NAME",
              "Boxes to use: label_02, det3d_pointrcnn (default without --images) or det2d_rrc");
  line.option(options.drive, 0, "images", "DRIVE",
              "Folder of the sequence's raw drive: images with labels, without poses");
  addOxtsPath(line, options);
}

/// The argument of `--degrade`, which is read before the command line so that --set overrides it.
std::string degradeFile(int argc, const char** argv) {
  const std::string name = "--degrade";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == name && i + 1 < argc) return argv[i + 1];
    if (word.rfind(name + "=", 0) == 0) return word.substr(name.size() + 1);
  }
  return "";
}

void addCommonOptions(CommandLine& line, ImportOptions& options) {
  const bool has_drive = options.dataset == "kitti-raw" || options.dataset == "kitti-tracking";
  line.option(options.output, 'o', "output", "OUT.rawlog", "Rawlog to write");
  addCheck(line, options.check);
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing output");
  line.option(options.detections, 0, "detections", "FILE",
              "Boxes that replace those of the dataset (doc/formats.md)");
  line.option(
      options.poses, 0, "poses", has_drive ? "FILE|oxts" : "FILE",
      std::string("Poses to use instead of visual SLAM: TUM (robot) or KITTI (left camera)") +
          (has_drive ? ", or the path of the raw drive's OXTS" : ""));
  line.option(options.from_index, 0, "from-index", "N", "Index of the first frame");
  line.option(options.to_index, 0, "to-index", "N", "Index of the last frame");
  line.flag(options.external_images, 0, "external-images",
            "Store images as PNG files in NAME_Images/");
}

/// Checks options that depend on each other, and completes their defaults.
void finish(ImportOptions& options) {
  const bool has_images = !options.drive.empty();
  if (options.dataset == "kitti-tracking" && !has_images && options.boxes.empty()) {
    options.boxes = kDefaultBoxes;
  }
  if (options.dataset == "images" && options.right.empty() == options.depth.empty()) {
    throw program::UsageError("give --right DIR for a stereo camera, or --depth DIR");
  }
  if (options.degrade && options.boxes.empty() && options.detections.empty()) {
    throw program::UsageError("--degrade requires --detections for this dataset");
  }
  if (options.poses == "oxts" && has_images) {
    options.use_oxts_poses = true;
    options.poses.clear();
  }
}

/// Datasets, and sub-commands with a command line of their own.
std::vector<program::Subcommand> subcommands() {
  return {{"kitti-odometry", "Converts a sequence of KITTI's odometry benchmark to a rawlog"},
          {"kitti-raw", "Converts a drive of KITTI's raw data to a rawlog"},
          {"kitti-tracking", "Converts a sequence of KITTI's tracking benchmark to a rawlog"},
          {"euroc", "Converts a flight of the EuRoC dataset to a rawlog"},
          {"tum-rgbd", "Converts a sequence of TUM's RGB-D benchmark to a rawlog"},
          {"images", "Converts folders of images of a stereo or depth camera to a rawlog"},
          {"rosbag", "Converts a bag of ROS 1 or ROS 2 to a rawlog"},
          {"rawlog", "Checks a rawlog"}};
}

std::string aboutOf(const std::string& dataset) {
  for (const auto& [name, about] : subcommands()) {
    if (name == dataset) return about;
  }
  return dataset;
}

}  // namespace

std::string takeSubcommand(int& argc, const char**& argv) {
  return program::takeSubcommand(argc, argv, "Converts datasets to rawlogs, and checks recordings.",
                                 subcommands());
}

std::optional<ImportOptions> parseOptions(int argc, const char** argv) {
  ImportOptions options;
  options.dataset = takeSubcommand(argc, argv);
  io::DegradeParams degrade;
  Params params;
  degrade.describe(params.section("degrade").user());
  std::string degrade_file = degradeFile(argc, argv);
  if (!degrade_file.empty()) params.loadFile(program::findDataFile(degrade_file));

  CommandLine line("headway-import " + options.dataset, aboutOf(options.dataset) + ".");
  addDatasetOptions(line, options);
  addCommonOptions(line, options);
  line.option(degrade_file, 0, "degrade", "FILE.ini",
              "Add noise, misses, duplicates and reversed headings to the boxes");
  line.parameters(params);
  if (!line.parse(argc, argv)) return std::nullopt;
  options.quiet = line.quiet();
  if (!degrade_file.empty()) options.degrade = degrade;
  finish(options);
  return options;
}

std::unique_ptr<io::Dataset> openDataset(const ImportOptions& options) {
  if (options.dataset == "kitti-odometry") {
    return io::openKittiOdometry(options.folder, options.sequence);
  }
  if (options.dataset == "kitti-raw") {
    return io::openKittiRaw(options.folder, options.drive, io::oxtsPathFrom(options.oxts_path));
  }
  if (options.dataset == "kitti-tracking" && !options.drive.empty()) {
    std::optional<io::KittiBoxes> boxes;
    if (!options.boxes.empty()) boxes = io::kittiBoxesFrom(options.boxes);
    return io::openKittiTracking(options.folder, options.sequence, boxes, options.drive,
                                 io::oxtsPathFrom(options.oxts_path));
  }
  if (options.dataset == "kitti-tracking") {
    return io::openKittiTracking(options.folder, options.sequence,
                                 io::kittiBoxesFrom(options.boxes));
  }
  if (options.dataset == "euroc") return io::openEuroc(options.folder);
  if (options.dataset == "tum-rgbd") return io::openTumRgbd(options.folder, options.calibration);
  if (!options.depth.empty()) {
    return io::openDepthFolders(options.left, options.depth, options.calibration);
  }
  return io::openImageFolders(options.left, options.right, options.calibration);
}

}  // namespace headway::import
