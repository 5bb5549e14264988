// SPDX-License-Identifier: BSD-3-Clause
// Sub-commands of headway-import that convert a dataset to a rawlog.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/dataset.h>
#include <headway/io/degrade.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "commands.h"
#include "recording_check.h"

namespace headway::import {
namespace {

using program::CommandLine;

/// Command-line options.
struct ImportOptions {
  std::string dataset;  ///< the sub-command
  std::string folder;
  std::string sequence;
  std::string drive;  ///< kitti-raw: its name; kitti-tracking: its folder, empty without images
  std::string boxes;  ///< empty: the default
  std::string oxts_path = "positions";
  std::string left;
  std::string right;
  std::string depth;  ///< images: instead of right
  std::string calibration;
  io::ImageTimes times;       ///< images: stated by the user
  bool side_by_side = false;  ///< images: each contains both

  std::string output;
  bool check = false;
  bool overwrite = false;
  bool external_images = false;
  std::string detections;       ///< side file; empty: boxes or poses of the dataset
  std::string poses;            ///< side file; empty: boxes or poses of the dataset
  bool use_oxts_poses = false;  ///< the true path of the raw drive as `pose`
  std::optional<io::DegradeParams> degrade;
  std::optional<std::size_t> from_index;
  std::optional<std::size_t> to_index;
  bool quiet = false;
};

/// Result of an import.
struct ImportSummary {
  std::size_t frames = 0;
  bool interrupted = false;
  std::map<std::string, std::size_t> dropped;  ///< by reason
};

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
    line.option(options.left, 0, "left", "DIR|VIDEO", "Folder or video of left images", true);
    line.option(options.right, 0, "right", "DIR|VIDEO", "Folder or video of right images");
    line.flag(options.side_by_side, 0, "side-by-side",
              "Instead: each left image contains both, the right camera's in its right half");
    line.option(options.depth, 0, "depth", "DIR", "Instead: folder of depth images, 16-bit PNG");
    line.option(options.calibration, 0, "calibration", "FILE",
                "Calibration of the pair: headway, MRPT, ROS, Kalibr, ORB-SLAM or OpenCV, two "
                "files separated by a comma; with --depth: headway (doc/formats.md)",
                true);
    line.option(options.times.rate_hz, 0, "rate", "HZ", "Images per second");
    line.option(options.times.file, 0, "times", "FILE",
                "Times of the left images, one a line [s]; default: those of the calibration, of "
                "times.txt, of the names, or 10 Hz");
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
  const std::initializer_list<bool> second_views = {!options.right.empty(), !options.depth.empty(),
                                                    options.side_by_side};
  if (options.dataset == "images" &&
      std::count(second_views.begin(), second_views.end(), true) != 1) {
    throw program::UsageError(
        "give one of --right DIR and --side-by-side for a stereo camera, or --depth DIR");
  }
  if (!(options.times.rate_hz >= 0.0) || !std::isfinite(options.times.rate_hz)) {
    throw program::UsageError("--rate: must be positive");
  }
  if (options.times.rate_hz > 0.0 && !options.times.file.empty()) {
    throw program::UsageError("give --rate or --times, not both");
  }
  if (options.degrade && options.boxes.empty() && options.detections.empty()) {
    throw program::UsageError("--degrade requires --detections for this dataset");
  }
  if (options.to_index && *options.to_index < options.from_index.value_or(0)) {
    throw program::UsageError("--to-index is before --from-index");
  }
  if (options.poses == "oxts" && has_images) {
    options.use_oxts_poses = true;
    options.poses.clear();
  }
}

/// Reads the command line; nullopt if the program is done (--help and similar).
std::optional<ImportOptions> parseOptions(const std::string& dataset, const std::string& about,
                                          int argc, const char** argv) {
  ImportOptions options;
  options.dataset = dataset;
  io::DegradeParams degrade;
  Params params;
  degrade.describe(params.section("degrade").user());
  std::string degrade_file = degradeFile(argc, argv);
  if (!degrade_file.empty()) params.loadFile(program::findDataFile(degrade_file));

  CommandLine line("headway-import " + dataset, about + ".");
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

/// Opens the selected dataset.
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
    return io::openDepthFolders(options.left, options.depth, options.calibration, options.times);
  }
  return io::openStereoImages(openImages(options.left),
                              options.side_by_side ? nullptr : openImages(options.right),
                              options.calibration, options.times);
}

/// Replaces the boxes and poses of the dataset by those of side files.
class SideFiles {
 public:
  SideFiles(const io::Dataset& dataset, const ImportOptions& options,
            std::map<std::string, std::size_t>& dropped)
      : camera_(dataset.camera()), use_truth_(options.use_oxts_poses) {
    if (!options.detections.empty()) {
      detections_ = io::readDetections(options.detections, dropped);
    }
    if (use_truth_ && dataset.gnss().empty()) {
      throw InputError("--poses oxts: the drive contains no OXTS data (folder oxts)");
    }
    if (!options.poses.empty()) {
      poses_ = io::PoseFile(options.poses, camera_ ? camera_->T_robot_left : robotFromOptical());
    }
    if (options.degrade) degrader_.emplace(*options.degrade);
  }

  void applyTo(io::DatasetFrame& frame, std::size_t index) {
    if (detections_) frame.detections = detectionsAt(index, frame.time);
    if (use_truth_) frame.T_map_robot = frame.truth_T_map_robot;
    if (poses_) frame.T_map_robot = poses_->at(index, frame.time);
    if (degrader_ && frame.detections) frame.detections = degrader_->degrade(*frame.detections);
  }

 private:
  Detections detectionsAt(std::size_t index, Time time) const {
    Detections detections;
    const auto found = detections_->find(index);
    if (found != detections_->end()) detections = found->second;
    detections.time = time;
    if (camera_) {
      detections.T_robot_sensor = camera_->T_robot_left;
      detections.image_width = camera_->left.width;
      detections.image_height = camera_->left.height;
    }
    return detections;
  }

  std::optional<io::RawStereoCamera> camera_;
  std::optional<std::map<std::size_t, Detections>> detections_;
  std::optional<io::PoseFile> poses_;
  bool use_truth_ = false;
  std::optional<io::Degrader> degrader_;
};

void write(io::RawlogSink& sink, const io::DatasetFrame& frame, const io::Dataset& dataset) {
  if (const auto depth_camera = dataset.depthCamera()) {
    sink.writeDepth(frame.time, frame.left, frame.depth, *depth_camera);
  } else if (const auto camera = dataset.camera()) {
    sink.writeStereo(frame.time, frame.left, frame.right, *camera);
  }
  if (frame.T_map_robot) sink.writePose("pose", frame.time, *frame.T_map_robot);
  if (frame.detections) sink.writeDetections("detections", *frame.detections);
  if (frame.truth_T_map_robot) {
    sink.writePose("truth_pose", frame.time, *frame.truth_T_map_robot);
  }
  if (frame.truth_objects) sink.writeDetections("truth_objects", *frame.truth_objects);
}

/// Writes inertial and GNSS samples in order of time.
class SensorWriter {
 public:
  explicit SensorWriter(const io::Dataset& dataset)
      : inertial_(dataset.inertial()), gnss_(dataset.gnss()) {}

  /// Writes the samples up to a time that are not written yet.
  void writeUntil(Time time, io::RawlogSink& sink) {
    for (; next_inertial_ < inertial_.size() && inertial_[next_inertial_].time <= time;
         ++next_inertial_) {
      const auto& sample = inertial_[next_inertial_];
      if (sample.angular_velocity) {
        sink.writeImu(sample.time, *sample.angular_velocity, sample.acceleration);
      } else {
        sink.writeAcceleration(sample.time, sample.acceleration);
      }
    }
    for (; next_gnss_ < gnss_.size() && gnss_[next_gnss_].time <= time; ++next_gnss_) {
      sink.writeGnss(gnss_[next_gnss_]);
    }
  }

 private:
  std::vector<io::DatasetInertial> inertial_;
  std::vector<io::RecordedGnss> gnss_;
  std::size_t next_inertial_ = 0;
  std::size_t next_gnss_ = 0;
};

/// Counts of those dropped images alone that lie in the time from the first to the last frame that
/// was imported.
void keepInRange(const io::Dataset& dataset, std::optional<Time> from, std::optional<Time> to,
                 std::map<std::string, std::size_t>& dropped) {
  for (const auto& [reason, times] : dataset.droppedTimes()) {
    const auto outside = std::count_if(times.begin(), times.end(), [&](Time time) {
      return (from && time < *from) || (to && time > *to);
    });
    if (outside > 0) dropped[reason] -= static_cast<std::size_t>(outside);
    if (dropped[reason] == 0) dropped.erase(reason);
  }
}

/// Writes the dataset and the side files as a rawlog.
ImportSummary importDataset(const io::Dataset& dataset, const ImportOptions& options) {
  ImportSummary summary;
  summary.dropped = dataset.dropped();
  SideFiles side_files(dataset, options, summary.dropped);
  const std::size_t first = options.from_index.value_or(0);
  const std::size_t end = std::min(dataset.size(), options.to_index.value_or(dataset.size()) + 1);
  if (first >= end) {
    throw InputError("--from-index " + std::to_string(first) + ": the dataset has only " +
                     std::to_string(dataset.size()) + " frames");
  }
  const auto storage =
      options.external_images ? io::ImageStorage::kExternalPng : io::ImageStorage::kEmbeddedRaw;
  io::RawlogSink sink(options.output, storage);
  SensorWriter sensors(dataset);
  program::Progress progress("frames", options.quiet);
  Time first_time = 0.0, last_time = 0.0;
  for (std::size_t index = first; index < end && !summary.interrupted; ++index) {
    io::DatasetFrame frame = dataset.frame(index);
    if (index == first) first_time = frame.time;
    last_time = frame.time;
    if (index == first && dataset.warnings().count(io::kTimesAssumed) > 0) {
      sink.writeTimesAssumed(frame.time);
    }
    side_files.applyTo(frame, index);
    sensors.writeUntil(frame.time, sink);
    write(sink, frame, dataset);
    ++summary.frames;
    progress.update(summary.frames,
                    static_cast<double>(summary.frames) / static_cast<double>(end - first));
    summary.interrupted = program::interrupted();
  }
  const bool is_to_end = first + summary.frames == dataset.size();
  keepInRange(dataset, first > 0 ? std::optional(first_time) : std::nullopt,
              is_to_end ? std::nullopt : std::optional(last_time), summary.dropped);
  sink.close();
  return summary;
}

/// Reads the beginning of a recording as a replay does, which refuses pairs that do not match.
/// @throws InputError
void requireUsablePairs(const std::string& rawlog) {
  io::RawlogSource source(rawlog, {});
  std::optional<Time> begin;
  try {
    while (const auto frame = source.next()) {
      if (!begin) begin = frame->time;
      if (frame->time - *begin > 2.5) return;  // it is decided by then at any usual rate
    }
  } catch (const InputError&) {
    std::error_code ignored;
    std::filesystem::remove(rawlog, ignored);  // what is refused is not there to be replayed
    throw;
  }
}

void report(const ImportOptions& options, const ImportSummary& summary) {
  std::cout << printable(options.output) << ": " << summary.frames << " frames"
            << (summary.interrupted ? ", interrupted" : "");
  for (const auto& [reason, count] : summary.dropped) {
    std::cout << ", skipped " << printable(reason) << " " << count;
  }
  std::cout << std::endl;
}

}  // namespace

int runDataset(const std::string& dataset_name, const std::string& about, int argc,
               const char** argv) {
  auto options = parseOptions(dataset_name, about, argc, argv);
  if (!options) return program::kDone;
  const ImportOutput output(options->output, options->check);
  options->output = output.path();
  for (const auto& read :
       {options->folder, options->drive, options->left, options->right, options->depth}) {
    program::registerDataset(read);
  }
  program::requireWritable(options->output, options->overwrite,
                           {options->detections, options->poses, options->calibration});
  const auto dataset = openDataset(*options);
  for (const auto& [name, warning] : dataset->warnings()) {
    std::cerr << "headway-import: warning: " << printable(name + ": " + warning.text) << std::endl;
  }
  program::catchInterrupts();
  const auto summary = importDataset(*dataset, *options);
  const bool is_compared = options->dataset == "images" && !options->check && !summary.interrupted;
  if (is_compared) requireUsablePairs(options->output);
  if (!options->quiet) report(*options, summary);
  return options->check ? checkRawlog(options->output) : program::kDone;
}

}  // namespace headway::import
