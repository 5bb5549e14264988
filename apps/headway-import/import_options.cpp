#include <headway/io/dataset.h>
#include <headway/program/command_line.h>

#include "importer.h"

namespace headway::import {
namespace {

using program::CommandLine;

void addDatasetOptions(CommandLine& line, ImportOptions& options) {
  if (options.dataset == "images") {
    line.option(options.left, 0, "left", "DIR", "Folder of left images", true);
    line.option(options.right, 0, "right", "DIR", "Folder of right images", true);
    line.option(options.calibration, 0, "calibration", "FILE",
                "Calibration of the pair (doc/formats.md)", true);
    return;
  }
  const bool is_euroc = options.dataset == "euroc";
  line.positional(options.folder, "DIR",
                  is_euroc                              ? "Folder that contains mav0/"
                  : options.dataset == "kitti-tracking" ? "Folder that contains training/"
                                                        : "Folder that contains sequences/");
  if (is_euroc) return;
  line.option(options.sequence, 0, "sequence", "NAME", "Sequence, such as 06 or 0001", true);
  if (options.dataset == "kitti-tracking") {
    line.option(options.boxes, 0, "boxes", "NAME",
                "Boxes to use: label_02, det3d_pointrcnn (default) or det2d_rrc");
  }
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

}  // namespace

std::optional<ImportOptions> parseOptions(int argc, const char** argv) {
  ImportOptions options;
  options.dataset =
      program::takeSubcommand(argc, argv, {"kitti-odometry", "kitti-tracking", "euroc", "images"});
  io::DegradeParams degrade;
  Params params;
  degrade.describe(params.section("degrade").user());
  std::string degrade_file = degradeFile(argc, argv);
  if (!degrade_file.empty()) params.loadFile(degrade_file);

  CommandLine line("headway-import " + options.dataset, "Converts a dataset to a rawlog.");
  addDatasetOptions(line, options);
  line.option(options.output, 'o', "output", "OUT.rawlog", "Rawlog to write", true);
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing output");
  line.option(options.detections, 0, "detections", "FILE",
              "Boxes that replace those of the dataset (doc/formats.md)");
  line.option(options.poses, 0, "poses", "FILE",
              "Poses to use instead of visual SLAM: TUM (robot) or KITTI (left camera)");
  line.option(degrade_file, 0, "degrade", "FILE.ini",
              "Add noise, misses, duplicates and reversed headings to the boxes");
  line.option(options.from_index, 0, "from-index", "N", "Index of the first frame");
  line.option(options.to_index, 0, "to-index", "N", "Index of the last frame");
  line.flag(options.external_images, 0, "external-images",
            "Store images as PNG files in NAME_Images/");
  line.parameters(params);
  if (!line.parse(argc, argv)) return std::nullopt;
  options.quiet = line.quiet();
  if (!degrade_file.empty()) options.degrade = degrade;
  if (options.degrade && options.dataset != "kitti-tracking" && options.detections.empty()) {
    throw program::UsageError("--degrade requires --detections for this dataset");
  }
  return options;
}

std::unique_ptr<io::Dataset> openDataset(const ImportOptions& options) {
  if (options.dataset == "kitti-odometry") {
    return io::openKittiOdometry(options.folder, options.sequence);
  }
  if (options.dataset == "kitti-tracking") {
    return io::openKittiTracking(options.folder, options.sequence,
                                 io::kittiBoxesFrom(options.boxes));
  }
  if (options.dataset == "euroc") return io::openEuroc(options.folder);
  return io::openImageFolders(options.left, options.right, options.calibration);
}

}  // namespace headway::import
