#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/io/degrade.h>
#include <headway/program/progress.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

#include "commands.h"
#include "suite_report.h"

namespace headway::app {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kQuickFrames = 80;  // 2 s of history, 3 s of future and 3 s of cases at 10 Hz

struct Options {
  bool quick = false;
  bool reuse = false;
  std::optional<std::size_t> frames;
  std::string worlds = "config/worlds";
  std::string folder = "suite";
  std::string kitti;
  std::string degrade;
  pipeline::PerceptionParams perception;
  bool quiet = false;
  Outputs outputs;
};

bool parse(Options& options, int argc, const char** argv) {
  program::CommandLine line(
      "headway-eval suite",
      "Simulates and replays every world and prints three tables: camera positions with each "
      "kind of rejection of moving objects, errors of every predictor, and positions of objects "
      "as detected and as tracked.");
  Params params;
  options.perception.describe(params);
  line.flag(options.quick, 0, "quick", "Use only the first 80 frames of every world");
  line.option(options.frames, 0, "frames", "N", "Use at most the first N frames of every world");
  line.option(
      options.worlds, 0, "worlds", "DIR",
      "Worlds to simulate: a folder of .ini files, one file, or none; default config/worlds");
  line.option(options.folder, 'o', "output", "OUTDIR",
              "Folder for recordings and tables; default suite");
  line.flag(options.reuse, 0, "reuse",
            "Reuse recordings in OUTDIR that were simulated with the same parameters");
  line.option(options.kitti, 0, "kitti", "DIR",
              "KITTI tracking benchmark, whose sequences are evaluated too");
  line.option(options.degrade, 0, "degrade", "FILE.ini",
              "Also evaluate positions on degraded KITTI boxes, seeds 1 to 5");
  line.parameters(params);
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  if (!options.degrade.empty() && options.kitti.empty()) {
    throw program::UsageError("--degrade applies to KITTI boxes and requires --kitti DIR");
  }
  if (options.worlds == "none" && options.kitti.empty()) {
    throw program::UsageError("--worlds none requires --kitti DIR");
  }
  options.quiet = line.quiet();
  options.outputs.requireWritable({});
  program::requireWritable(options.folder, options.outputs.overwrite() || options.reuse);
  return true;
}

std::vector<std::string> worldFiles(const std::string& path) {
  if (path == "none") return {};
  if (fs::is_regular_file(path)) return {path};
  if (!fs::is_directory(path))
    throw InputError(path + ": no such file or folder of worlds; check --worlds");
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.path().extension() == ".ini") files.push_back(entry.path());
  }
  if (files.empty()) throw InputError(path + ": contains no worlds (.ini)");
  std::sort(files.begin(), files.end());
  return files;
}

/// Runs the suite, one recording at a time.
class Suite {
 public:
  explicit Suite(const Options& options)
      : options_(options),
        progress_("suite", options.quiet),
        worlds_(worldSources(worldFiles(options.worlds))) {
    max_frames_ = options.frames;
    if (options.quick) max_frames_ = kQuickFrames;
    for (const auto& source : worlds_) {
      const std::size_t frames = framesOf(source);
      total_ += (1 + rejectionsFor(source).size()) * std::min(frames, max_frames_.value_or(frames));
    }
  }

  [[nodiscard]] std::vector<SuiteEntry> run() {
    for (const auto& source : worlds_) {
      if (!program::interrupted()) evaluateWorld(source);
    }
    closeGroup("all worlds");
    if (options_.kitti.empty()) return std::move(entries_);
    const auto recordings = readKittiTracking(options_.kitti);
    for (const auto& recording : recordings) {
      if (program::interrupted()) break;
      addObjects(recording, options_.perception.objects);
      entries_.back().in_plot = false;
    }
    closeGroup("all KITTI");
    if (!options_.degrade.empty()) evaluateDegraded(recordings);
    return std::move(entries_);
  }

 private:
  /// Kinds of rejection that a world is replayed with; `both` is the last.
  static std::vector<Rejection> rejectionsFor(const WorldSource& source) {
    if (source.all_rejections) return rejections();
    return {rejections().back()};
  }

  void evaluateWorld(const WorldSource& source) {
    const FrameDone done = [this] {
      const std::lock_guard lock(progress_mutex_);
      ++done_;
      progress_.update(done_, static_cast<double>(done_) / static_cast<double>(total_));
      return !program::interrupted();
    };
    std::optional<World> existing;
    if (options_.reuse) existing = existingWorld(source, options_.folder, max_frames_);
    const World world =
        existing ? *existing : simulateWorld(source, options_.folder, max_frames_, done);
    if (existing) done_ += world.frames;
    const auto kinds = rejectionsFor(source);
    std::vector<pipeline::PerceptionParams> params(kinds.size(), options_.perception);
    for (std::size_t i = 0; i < params.size(); ++i) {
      params[i].slam.dynamic_rejection = kinds[i].value;
    }
    std::vector<WorldRun> runs;
    if (!program::interrupted()) runs = runWorld(world, params, done);
    if (program::interrupted()) {  // an incomplete world is not evaluated
      entries_.push_back({world.name, {}, std::nullopt});
      return;
    }
    addObjects(runs.back().objects, options_.perception.objects);
    for (std::size_t i = 0; i < runs.size(); ++i) {
      entries_.back().camera.emplace_back(
          kinds[i].name,
          CameraFigures{world.frames, world.frames_wanted, runs[i].lost, runs[i].error});
    }
  }

  void addObjects(const ObjectRecording& recording, const objects::ObjectsParams& params) {
    const auto figures = runObjects(recording, params);
    entries_.push_back({recording.name, {}, evaluateObjects(figures)});
    add(figures, group_);
    ++in_group_;
  }

  /// Adds an entry per seed: positions from all recordings with degraded boxes.
  void evaluateDegraded(const std::vector<ObjectRecording>& recordings) {
    constexpr int kSeeds = 5;
    io::DegradeParams degrade;
    Params params;
    degrade.describe(params.section("degrade").user());
    params.loadFile(options_.degrade);
    for (int seed = 1; seed <= kSeeds && !program::interrupted(); ++seed) {
      degrade.seed = seed;
      ObjectFigures together;
      for (ObjectRecording recording : recordings) {
        io::Degrader degrader(degrade);
        for (auto& frame : recording.frames) {
          if (frame.detections) frame.detections = degrader.degrade(*frame.detections);
        }
        add(runTracks(recording, options_.perception.objects), together);
      }
      const auto name = "all KITTI, degraded, seed " + std::to_string(seed);
      entries_.push_back({name, {}, evaluateObjects(together), false, true});
    }
  }

  /// Adds an entry for all recordings since the previous group.
  void closeGroup(const std::string& name) {
    if (in_group_ > 1) entries_.push_back({name, {}, evaluateObjects(group_), true, true});
    group_ = {};
    in_group_ = 0;
  }

  const Options& options_;
  program::Progress progress_;
  std::mutex progress_mutex_;
  std::vector<WorldSource> worlds_;
  std::optional<std::size_t> max_frames_;
  std::size_t total_ = 0;
  std::size_t done_ = 0;
  std::vector<SuiteEntry> entries_;
  ObjectFigures group_;  ///< of the recordings since the previous group
  std::size_t in_group_ = 0;
};

}  // namespace

int runSuite(int argc, const char** argv) {
  Options options;
  if (!parse(options, argc, argv)) return program::kDone;
  program::catchInterrupts();
  Suite suite(options);
  fs::create_directories(options.folder);
  const auto entries = suite.run();
  OutputFile file(fs::path(options.folder) / "suite.md");
  writeSuite(file.stream(), entries);
  file.commit();
  if (!options.quiet) writeSuite(std::cout, entries);
  options.outputs.write([&] { return suiteFigures(entries); }, [&] { return suitePlot(entries); });
  return program::kDone;
}

}  // namespace headway::app
