// SPDX-License-Identifier: BSD-3-Clause
#include <google/protobuf/descriptor.pb.h>
#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/program/command_line.h>
#include <headway/program/progress.h>
#include <headway/report/replay_frames.h>

#include <functional>
#include <iostream>
#include <optional>
#include <set>

#include "foxglove_messages.h"
#include "mcap_writer.h"
#include "replay_commands.h"

namespace headway::exporting {
namespace {

namespace fs = std::filesystem;
using report::ReplayFrame;

struct McapOptions {
  std::string folder;
  std::string output;
  bool without_images = false;
  bool overwrite = false;
  bool quiet = false;
};

bool parse(int argc, const char** argv, McapOptions& options) {
  program::CommandLine line("headway-export mcap",
                            "Writes a finished replay as an MCAP file for Foxglove and other "
                            "viewers: poses, tf, images, calibration, points, grid, boxes and "
                            "predictions.");
  Params none;
  line.positional(options.folder, "OUTDIR", "Folder of a finished replay");
  line.option(options.output, 'o', "output", "X.mcap", "File to write", true);
  line.flag(options.without_images, 0, "no-images", "Leave out the camera's images");
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing file");
  line.parameters(none);
  if (!line.parse(argc, argv)) return false;
  options.quiet = line.quiet();
  return true;
}

/// The message's file of types and those it imports, as MCAP wants a Protobuf schema.
std::string descriptionOf(const google::protobuf::Descriptor& type) {
  google::protobuf::FileDescriptorSet files;
  std::set<std::string> seen;
  const std::function<void(const google::protobuf::FileDescriptor&)> add =
      [&](const google::protobuf::FileDescriptor& file) {
        if (!seen.insert(file.name()).second) return;
        for (int i = 0; i < file.dependency_count(); ++i) add(*file.dependency(i));
        file.CopyTo(files.add_file());
      };
  add(*type.file());
  return files.SerializeAsString();
}

/// One topic of messages of a type.
template <typename Message>
class Topic {
 public:
  Topic(const std::string& name, McapWriter& mcap)
      : mcap_(mcap),
        id_(mcap.addTopic(name, Message::descriptor()->full_name(), "protobuf",
                          descriptionOf(*Message::descriptor()))) {}

  void write(Time time, const Message& message) {
    mcap_.write(id_, nanoseconds(time), message.SerializeAsString());
  }

 private:
  McapWriter& mcap_;
  std::uint16_t id_;
};

/// The map, which is written once, at the time of the first frame.
void writeMap(const fs::path& folder, Time time, McapWriter& mcap) {
  for (const char* name : {"dense", "points"}) {
    const fs::path file = folder / (std::string("map_") + name + ".ply");
    if (!fs::exists(file)) continue;
    Topic<foxglove::PointCloud> topic(std::string("/map/") + name, mcap);
    topic.write(time, cloudOf(time, report::readPoints(file, 0)));
  }
  if (const auto grid = report::readGrid(folder / "map_grid.yaml")) {
    Topic<foxglove::Grid>("/map/grid", mcap).write(time, gridOf(time, *grid));
  }
}

/// What is written of each frame.
class FrameTopics {
 public:
  FrameTopics(const std::optional<StereoCamera>& camera, McapWriter& mcap)
      : camera_(camera),
        transforms_("/tf", mcap),
        pose_("/pose", mcap),
        boxes_("/tracks", mcap),
        predictions_("/predictions", mcap) {
    if (!camera_) return;
    calibration_.emplace("/camera/calibration", mcap);
    image_.emplace("/camera/image", mcap);
  }

  void write(const ReplayFrame& frame, const cv::Mat& image) {
    transforms_.write(frame.time,
                      transformsOf(frame, camera_ ? camera_->T_robot_cam : robotFromOptical()));
    pose_.write(frame.time, poseOf(frame));
    boxes_.write(frame.time, boxesOf(frame));
    predictions_.write(frame.time, predictionsOf(frame));
    if (!camera_) return;
    calibration_->write(frame.time, calibrationOf(frame.time, *camera_));
    if (!image.empty()) image_->write(frame.time, imageOf(frame.time, image));
  }

 private:
  std::optional<StereoCamera> camera_;
  Topic<foxglove::FrameTransforms> transforms_;
  Topic<foxglove::PoseInFrame> pose_;
  Topic<foxglove::SceneUpdate> boxes_, predictions_;
  std::optional<Topic<foxglove::CameraCalibration>> calibration_;
  std::optional<Topic<foxglove::CompressedImage>> image_;
};

}  // namespace

int runMcapExport(int argc, const char** argv) {
  McapOptions options;
  if (!parse(argc, argv, options)) return program::kDone;
  program::requireWritable(options.output, options.overwrite);
  const fs::path folder(options.folder);
  const auto note = [&](const std::string& text) {
    if (!options.quiet) std::cerr << "headway-export: " << text << '\n';
  };
  report::ReplayFrameOptions reading;
  reading.past_s = 0.0;
  const auto frames = report::readReplayFrames(folder, reading, note);
  std::optional<StereoCamera> camera;
  if (fs::exists(folder / "calibration.yaml")) {
    camera = io::readCalibration(folder / "calibration.yaml");
  }
  std::optional<report::RecordedImages> images;
  if (camera && !options.without_images) {
    images.emplace(report::readReplayInput(folder), frames.front().frame, note);
  }
  program::catchInterrupts();
  McapWriter mcap(options.output);
  Topic<foxglove::PosesInFrame>("/path", mcap).write(frames.front().time, pathOf(frames));
  writeMap(folder, frames.front().time, mcap);
  FrameTopics topics(camera, mcap);
  program::Progress progress("frames", options.quiet);
  std::size_t done = 0;
  for (const auto& frame : frames) {
    if (program::interrupted()) break;
    topics.write(frame, images ? images->at(frame.frame) : cv::Mat());
    ++done;
    progress.update(done, static_cast<double>(done) / static_cast<double>(frames.size()));
  }
  progress.finish();
  mcap.finish();
  if (!options.quiet) std::cout << options.output << ": " << done << " frames" << std::endl;
  return program::kDone;
}

}  // namespace headway::exporting
