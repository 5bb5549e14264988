// SPDX-License-Identifier: BSD-3-Clause
#include "suite_runs.h"

#include <headway/core/byte_archive.h>
#include <headway/core/output_file.h>
#include <headway/core/version.h>
#include <headway/io/rawlog_source.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace headway::app {
namespace {

namespace fs = std::filesystem;

/// What a replay adds to a frame of the recording.
struct StoredFrame {
  bool has_detections = false;
  Pose T_map_robot = Pose::Identity();
};

struct StoredRun {
  std::size_t lost = 0;
  std::vector<Stamped<Pose>> estimate;
  std::vector<StoredFrame> frames;
};

fs::path fileOf(const World& world) { return fs::path(world.rawlog).replace_extension(".runs"); }

Pose readPose(ByteReader& in) {
  Pose pose;
  pose.matrix() = in.finiteMatrix<Eigen::Matrix4d>();
  return pose;
}

StoredRun readRun(ByteReader& in) {
  StoredRun run;
  run.lost = in.value<std::uint64_t>();
  run.estimate = in.list<Stamped<Pose>>([](ByteReader& from) {
    const auto time = from.finiteValue<Time>();
    return Stamped<Pose>{time, readPose(from)};
  });
  run.frames = in.list<StoredFrame>([](ByteReader& from) {
    const bool has_detections = from.value<std::uint8_t>() != 0;
    return StoredFrame{has_detections, readPose(from)};
  });
  return run;
}

void writeRun(const WorldRun& run, ByteWriter& out) {
  out.count(run.lost);
  out.count(run.estimate.size());
  for (const auto& [time, T_map_robot] : run.estimate) {
    out.value(time);
    out.matrix(T_map_robot.matrix());
  }
  out.count(run.objects.frames.size());
  for (const auto& frame : run.objects.frames) {
    out.value<std::uint8_t>(frame.detections ? 1 : 0);
    out.matrix(frame.T_map_robot.value().matrix());
  }
}

/// The world's frames with the poses of a run, without images.
ObjectRecording recordingOf(const World& world, const StoredRun& run) {
  io::RawlogSource source(world.rawlog, {});
  ObjectRecording recording = describedRecording(world, *source.camera());
  for (const auto& stored : run.frames) {
    auto frame = source.next();
    if (!frame)
      throw InputError(world.rawlog + ": has fewer frames than " + fileOf(world).string());
    frame->stereo.reset();
    frame->T_map_robot = stored.T_map_robot;
    if (!stored.has_detections) frame->detections.reset();
    recording.frames.push_back(std::move(*frame));
  }
  return recording;
}

}  // namespace

void writeRuns(const World& world, const std::string& parameters,
               const std::vector<WorldRun>& runs) {
  ByteWriter out;
  out.text(kVersion);
  out.text(parameters);
  out.count(runs.size());
  for (const auto& run : runs) writeRun(run, out);
  writeFile(fileOf(world), out.bytes);
}

std::vector<WorldRun> readRuns(const World& world, const std::string& parameters) {
  const fs::path path = fileOf(world);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path.string() + ": cannot be read; it is left by suite --only-runs");
  std::ostringstream bytes;
  bytes << file.rdbuf();
  const std::string content = bytes.str();
  ByteReader in(content);
  try {
    if (in.text() != kVersion || in.text() != parameters) {
      throw InputError("is of another version or of other parameters");
    }
    const auto stored = in.list<StoredRun>(readRun);
    std::vector<WorldRun> runs;
    for (const auto& run : stored) {
      runs.push_back({});
      runs.back().lost = run.lost;
      runs.back().estimate = run.estimate;
      if (&run == &stored.back()) runs.back().objects = recordingOf(world, run);
      evaluate(world, runs.back());
    }
    return runs;
  } catch (const InputError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

}  // namespace headway::app
