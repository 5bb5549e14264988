// SPDX-License-Identifier: BSD-3-Clause
// Recordings of the suite: simulated worlds, runs of the pipeline over them, KITTI sequences.
#include "suite_worlds.h"

#include <headway/core/byte_archive.h>
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/core/version.h>
#include <headway/core/worker_thread.h>
#include <headway/eval/labelled_frames.h>
#include <headway/io/dataset.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway/program/truth_report.h>
#include <headway/run/session.h>
#include <headway/sim/recording.h>
#include <headway/sim/rigs.h>
#include <headway/sim/simulator.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <future>

namespace headway::app {
namespace {

namespace fs = std::filesystem;

/// A world's parameters and the registry they are bound to.
struct WorldSettings {
  explicit WorldSettings(const WorldSource& source, std::optional<std::size_t> max_frames = {}) {
    values.describe(params);
    params.loadFile(source.ini);
    if (!source.rig.empty()) sim::applyRig(source.rig, values.camera);
    auto& frames = values.recording.frames;
    if (max_frames) frames = std::min(frames, static_cast<int>(*max_frames));
    if (source.rate_hz <= 0.0) return;
    frames = static_cast<int>(std::lround(frames * source.rate_hz / values.camera.rate_hz));
    values.camera.rate_hz = source.rate_hz;
  }
  WorldSettings(const WorldSettings&) = delete;
  WorldSettings& operator=(const WorldSettings&) = delete;

  sim::SimParams values;
  Params params;
};

/// File names of a world in `folder`, before it is simulated.
World plannedWorld(const WorldSettings& settings, const WorldSource& source,
                   const std::string& folder) {
  World world;
  world.frames_wanted = static_cast<std::size_t>(settings.values.recording.frames);
  world.name = fs::path(source.ini).stem();
  if (!source.rig.empty()) world.name += "-" + source.rig;
  world.rawlog = (fs::path(folder) / (world.name + ".rawlog")).string();
  world.truth_folder = sim::truthFolder(world.rawlog);
  return world;
}

/// A world's recording without frames: name and camera.
ObjectRecording describedRecording(const World& world, const StereoCamera& camera) {
  ObjectRecording recording;
  recording.name = world.name;
  recording.camera = camera;
  recording.T_robot_cam = camera.T_robot_cam;
  return recording;
}

/// Adds to a run's estimate and frames the error and the labels, from the world's truth.
void evaluate(const World& world, WorldRun& run) {
  if (run.estimate.size() >= 3) {  // which an alignment needs
    const auto truth = io::readTum(world.truth_folder + "/trajectory.tum");
    run.error =
        eval::trajectoryError(eval::pairByTime(truth, run.estimate, program::kSameTime_s), {});
  }
  // An empty file is the truth of a place in which no object came into view.
  const std::string labels = world.truth_folder + "/label_02.txt";
  if (fs::file_size(labels) > 0) run.objects.labels = eval::readLabels(labels);
  run.objects.labels.resize(std::min(run.objects.labels.size(), run.objects.frames.size()));
}

WorldRun runOnce(const World& world, pipeline::PerceptionParams params, const FrameDone& done) {
  params.slam.stop = stopRequested;
  run::RawlogFrames source(world.rawlog);
  pipeline::Perception perception(source.camera(), params);
  run::SessionOptions options;
  options.end_at_fatal_finding = true;
  run::Session session(source, perception, {}, options);
  WorldRun run;
  run.objects = describedRecording(world, *source.camera());
  while (auto result = session.next()) {
    const auto& camera = result->update.camera;
    const bool tracked = slam::isTracked(camera.status);
    if (!tracked) ++run.lost;
    RecordedFrame& frame = result->frame;
    frame.stereo.reset();
    frame.T_map_robot = camera.T_map_robot;
    if (!tracked) frame.detections.reset();
    run.objects.frames.push_back(std::move(frame));
    if (!done()) break;
  }
  for (const auto& frame : perception.trajectory()) {
    if (frame.tracked) run.estimate.push_back({frame.time, frame.T_map_robot});
  }
  evaluate(world, run);
  return run;
}

fs::path fileOf(const World& world) { return fs::path(world.rawlog).replace_extension(".runs"); }

Pose readPose(ByteReader& in) {
  Pose pose;
  pose.matrix() = in.finiteMatrix<Eigen::Matrix4d>();
  return pose;
}

/// A run as it was stored: of its frames only the poses, and which of them have boxes.
WorldRun readRun(ByteReader& in) {
  WorldRun run;
  run.lost = in.value<std::uint64_t>();
  run.estimate = in.list<Stamped<Pose>>([](ByteReader& from) {
    const auto time = from.finiteValue<Time>();
    return Stamped<Pose>{time, readPose(from)};
  });
  run.objects.frames = in.list<RecordedFrame>([](ByteReader& from) {
    RecordedFrame frame;
    if (from.value<std::uint8_t>() != 0) frame.detections.emplace();
    frame.T_map_robot = readPose(from);
    return frame;
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
ObjectRecording recordingOf(const World& world, const WorldRun& run) {
  io::RawlogSource source(world.rawlog, {});
  ObjectRecording recording = describedRecording(world, *source.camera());
  for (const RecordedFrame& stored : run.objects.frames) {
    auto frame = source.next();
    if (!frame)
      throw InputError(world.rawlog + ": has fewer frames than " + fileOf(world).string());
    frame->stereo.reset();
    frame->T_map_robot = stored.T_map_robot;
    if (!stored.detections) frame->detections.reset();
    recording.frames.push_back(std::move(*frame));
  }
  return recording;
}

}  // namespace

std::vector<WorldSource> worldSources(const std::vector<std::string>& files) {
  std::vector<WorldSource> sources;
  for (const std::string& file : files) {
    const WorldSource own{file, "", true};
    if (WorldSettings(own).values.world.kind == sim::WorldParams::Kind::kStreet) {
      sources.push_back(own);
      continue;
    }
    for (const std::string rig : {"robot", "small"}) sources.push_back({file, rig, false});
  }
  return sources;
}

std::size_t framesOf(const WorldSource& source, std::optional<std::size_t> max_frames) {
  return static_cast<std::size_t>(WorldSettings(source, max_frames).values.recording.frames);
}

World simulateWorld(const WorldSource& source, const std::string& folder,
                    std::optional<std::size_t> max_frames, const FrameDone& done) {
  WorldSettings settings(source, max_frames);
  World world = plannedWorld(settings, source, folder);
  sim::Simulator simulator(settings.values);
  sim::Recording recording(world.rawlog, settings.values.recording, {}, simulator.camera(),
                           simulator.recordedCamera(), program::textOf(settings.params));
  bool proceed = true;
  while (proceed) {
    const auto frame = simulator.next();
    if (!frame) break;
    recording.write(*frame);
    ++world.frames;
    proceed = done();
  }
  recording.close();
  return world;
}

std::optional<World> existingWorld(const WorldSource& source, const std::string& folder,
                                   std::optional<std::size_t> max_frames) {
  WorldSettings settings(source, max_frames);
  World world = plannedWorld(settings, source, folder);
  const fs::path ini = fs::path(world.truth_folder) / "world.ini";
  if (!fs::exists(world.rawlog) || !fs::exists(ini) ||
      program::readFile(ini) != program::textOf(settings.params))
    return std::nullopt;
  world.frames = io::readTum(world.truth_folder + "/trajectory.tum").size();
  return world;
}

std::vector<WorldRun> runWorld(const World& world,
                               const std::vector<pipeline::PerceptionParams>& params,
                               const FrameDone& done, std::size_t threads) {
  std::vector<WorldRun> runs(params.size());
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < params.size(); i = next++) {
      runs[i] = runOnce(world, params[i], done);
    }
  };
  std::vector<std::future<void>> workers;
  for (std::size_t i = 0; i < std::min(params.size(), threads); ++i) {
    workers.push_back(std::async(std::launch::async, work));
  }
  for (auto& worker : workers) worker.get();
  return runs;
}

std::vector<ObjectRecording> readKittiTracking(const std::string& folder) {
  const fs::path labels = fs::path(folder) / "training" / "label_02";
  if (!fs::is_directory(labels)) throw InputError(labels.string() + ": no such folder");
  std::vector<std::string> names;
  for (const auto& file : fs::directory_iterator(labels)) names.push_back(file.path().stem());
  std::sort(names.begin(), names.end());
  std::vector<ObjectRecording> recordings;
  for (const auto& name : names) {
    ObjectRecording recording;
    recording.name = "KITTI " + name;
    const auto dataset = io::openKittiTracking(folder, name, io::KittiBoxes::kPointRcnn3d);
    for (std::size_t k = 0; k < dataset->size(); ++k) {
      auto frame = dataset->frame(k);
      recording.frames.push_back(
          {k, frame.time, {}, frame.detections, frame.T_map_robot, {}, 0.0, {}});
    }
    recording.labels = eval::readLabels((labels / (name + ".txt")).string());
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

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
  if (!fs::exists(path)) {
    throw InputError(path.string() + ": cannot be read; it is left by suite --only-runs");
  }
  const std::string content = program::readFile(path);
  ByteReader in(content);
  try {
    if (in.text() != kVersion || in.text() != parameters) {
      throw InputError("is of another version or of other parameters");
    }
    auto runs = in.list<WorldRun>(readRun);
    for (auto& run : runs) {
      run.objects = &run == &runs.back() ? recordingOf(world, run) : ObjectRecording();
      evaluate(world, run);
    }
    return runs;
  } catch (const InputError& error) {
    throw InputError(path.string() + ": " + error.what());
  }
}

}  // namespace headway::app
