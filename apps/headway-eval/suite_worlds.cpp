// SPDX-License-Identifier: BSD-3-Clause
#include "suite_worlds.h"

#include <headway/core/error.h>
#include <headway/core/worker_thread.h>
#include <headway/eval/labelled_frames.h>
#include <headway/io/dataset.h>
#include <headway/io/trajectory_file.h>
#include <headway/run/session.h>
#include <headway/sim/recording.h>
#include <headway/sim/rigs.h>
#include <headway/sim/simulator.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <future>
#include <sstream>

namespace headway::app {
namespace {

namespace fs = std::filesystem;

constexpr double kSameTime_s = 0.02;

/// A world's parameters and the registry they are bound to.
struct WorldSettings {
  explicit WorldSettings(const WorldSource& source, std::optional<std::size_t> max_frames = {}) {
    values.describe(params);
    params.loadFile(source.ini);
    if (!source.rig.empty()) sim::applyRig(source.rig, values.camera);
    auto& frames = values.recording.frames;
    if (max_frames) frames = std::min(frames, static_cast<int>(*max_frames));
  }
  WorldSettings(const WorldSettings&) = delete;
  WorldSettings& operator=(const WorldSettings&) = delete;

  [[nodiscard]] std::string text() const {
    std::ostringstream text;
    params.print(text);
    return text.str();
  }

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

std::size_t framesOf(const WorldSource& source) {
  return static_cast<std::size_t>(WorldSettings(source).values.recording.frames);
}

World simulateWorld(const WorldSource& source, const std::string& folder,
                    std::optional<std::size_t> max_frames, const FrameDone& done) {
  WorldSettings settings(source, max_frames);
  World world = plannedWorld(settings, source, folder);
  sim::Simulator simulator(settings.values);
  sim::Recording recording(world.rawlog, settings.values.recording, {}, simulator.camera(),
                           simulator.recordedCamera(), settings.text());
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
  std::ifstream world_ini(fs::path(world.truth_folder) / "world.ini");
  std::ostringstream text;
  text << world_ini.rdbuf();
  if (!fs::exists(world.rawlog) || text.str() != settings.text()) return std::nullopt;
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

ObjectRecording describedRecording(const World& world, const StereoCamera& camera) {
  ObjectRecording recording;
  recording.name = world.name;
  recording.camera = camera;
  recording.T_robot_cam = camera.T_robot_cam;
  return recording;
}

void evaluate(const World& world, WorldRun& run) {
  constexpr std::size_t kMinPoses = 3;  // for an alignment
  if (run.estimate.size() >= kMinPoses) {
    const auto truth = io::readTum(world.truth_folder + "/trajectory.tum");
    run.error = eval::trajectoryError(eval::pairByTime(truth, run.estimate, kSameTime_s), {});
  }
  // An empty file is the truth of a place in which no object came into view.
  const std::string labels = world.truth_folder + "/label_02.txt";
  if (fs::file_size(labels) > 0) run.objects.labels = eval::readLabels(labels);
  run.objects.labels.resize(std::min(run.objects.labels.size(), run.objects.frames.size()));
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

}  // namespace headway::app
