// SPDX-License-Identifier: BSD-3-Clause
#include "importer.h"

#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/command_line.h>
#include <headway/program/progress.h>

#include <algorithm>

namespace headway::import {
namespace {

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
      sink.writeImu(sample.time, sample.angular_velocity, sample.acceleration);
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

}  // namespace

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
  for (std::size_t index = first; index < end && !summary.interrupted; ++index) {
    io::DatasetFrame frame = dataset.frame(index);
    side_files.applyTo(frame, index);
    sensors.writeUntil(frame.time, sink);
    write(sink, frame, dataset);
    ++summary.frames;
    progress.update(summary.frames,
                    static_cast<double>(summary.frames) / static_cast<double>(end - first));
    summary.interrupted = program::interrupted();
  }
  sink.close();
  return summary;
}

}  // namespace headway::import
