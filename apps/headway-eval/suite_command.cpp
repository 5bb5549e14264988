// SPDX-License-Identifier: BSD-3-Clause
// headway-eval suite: all worlds simulated, replayed and evaluated, here or by headway-fleet.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/io/degrade.h>
#include <headway/pipeline/perception.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <iostream>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <vector>

#include "commands.h"
#include "suite_report.h"
#include "suite_worlds.h"

namespace headway::app {

namespace {

namespace fs = std::filesystem;

/// Worlds that headway-fleet simulates and replays, a job each.
struct WorldJobs {
  std::vector<std::string> worlds;  ///< .ini files
  std::string folder;               ///< of recordings and runs, as of the suite
  std::optional<std::size_t> max_frames;
  int at_once = 1;      ///< cores here, or jobs with a profile
  std::string profile;  ///< of Snakemake; empty: here
  bool quiet = false;
};

/// Runs a program to its end; its exit status, or 128 + signal.
int run(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawn(&child, words.front().c_str(), nullptr, nullptr, arguments.data(), environ) !=
      0) {
    throw InputError(words.front() + ": cannot be run; it is installed with headway-eval");
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

std::string textOf(pipeline::PerceptionParams perception) {
  Params params;
  perception.describe(params);
  return program::textOf(params);
}

/// Runs all jobs by the headway-fleet beside this program; those whose results exist are not run
/// again. The parameters are written to `suite.ini` in the folder.
///
/// @throws InputError if headway-fleet is missing or a job failed, which it reports itself
void runWorldJobs(const WorldJobs& jobs, const pipeline::PerceptionParams& perception) {
  fs::create_directories(jobs.folder);
  const fs::path parameters = fs::path(jobs.folder) / "suite.ini";
  writeFile(parameters, textOf(perception));
  const fs::path programs = fs::read_symlink("/proc/self/exe").parent_path();
  std::vector<std::string> words = {(programs / "headway-fleet").string(), "--suite"};
  words.insert(words.end(), jobs.worlds.begin(), jobs.worlds.end());
  for (const std::string& word :
       {std::string("-o"), jobs.folder, std::string("-c"), parameters.string(), std::string("-j"),
        std::to_string(jobs.at_once), std::string("--programs"), programs.string()}) {
    words.push_back(word);
  }
  if (!jobs.profile.empty()) words.insert(words.end(), {"--profile", jobs.profile});
  if (jobs.max_frames) words.insert(words.end(), {"--frames", std::to_string(*jobs.max_frames)});
  if (jobs.quiet) words.emplace_back("-q");
  if (run(words) != 0) throw InputError(jobs.folder + ": not all worlds were replayed; see above");
}

constexpr std::size_t kQuickFrames = 80;  // 2 s of history, 3 s of future and 3 s of cases at 10 Hz

struct SuiteOptions {
  bool quick = false;
  bool reuse = false;
  bool only_runs = false;
  int jobs = 0;  ///< 0: no jobs, the worlds run in this process
  std::string profile;
  std::optional<std::size_t> frames;
  double rate_hz = 0.0;  ///< 0: each rig's own
  std::string worlds = "config/worlds";
  std::string folder = "suite";
  std::string kitti;
  std::string degrade;
  pipeline::PerceptionParams perception;
  Outputs outputs;
};

/// @throws UsageError if options exclude or require each other
void checkTogether(const SuiteOptions& options) {
  if (!options.degrade.empty() && options.kitti.empty()) {
    throw program::UsageError("--degrade applies to KITTI boxes and requires --kitti DIR");
  }
  if (options.worlds == "none" && options.kitti.empty()) {
    throw program::UsageError("--worlds none requires --kitti DIR");
  }
  if (options.jobs < 0) throw program::UsageError("--jobs must be positive");
  if (!options.profile.empty() && options.jobs == 0) {
    throw program::UsageError("--profile requires --jobs N");
  }
  if (options.rate_hz != 0.0 && !(options.rate_hz >= 0.5 && options.rate_hz <= 100.0)) {
    throw program::UsageError("--rate must be between 0.5 and 100 Hz");
  }
  if (options.rate_hz > 0.0 && options.jobs > 0) {
    throw program::UsageError("--rate excludes --jobs");
  }
  if (options.only_runs && (options.jobs > 0 || !options.kitti.empty())) {
    throw program::UsageError("--only-runs excludes --jobs and --kitti");
  }
}

void addJobOptions(program::CommandLine& line, SuiteOptions& options) {
  line.option(options.jobs, 0, "jobs", "N",
              "Simulate and replay the worlds by headway-fleet, a job each: N cores, or N jobs "
              "at once with --profile; the tables are the same");
  line.option(
      options.profile, 0, "profile", "NAME|DIR",
      "With --jobs: run them on a cluster (slurm, or a folder with a profile of Snakemake)");
  line.flag(options.only_runs, 0, "only-runs",
            "Simulate and replay only, by one core, and store the runs: a job of --jobs");
}

bool parseSuite(SuiteOptions& options, int argc, const char** argv) {
  program::CommandLine line(
      "headway-eval suite",
      "Simulates and replays every world and prints three tables: camera positions with each "
      "kind of rejection of moving objects, errors of every predictor, and positions of objects "
      "as detected and as tracked.");
  Params params;
  options.perception.describe(params);
  line.flag(options.quick, 0, "quick", "Use only the first 80 frames of every world");
  line.option(options.frames, 0, "frames", "N", "Use at most the first N frames of every world");
  line.option(options.rate_hz, 0, "rate", "HZ",
              "Frames a second instead of each rig's, for the same time");
  line.option(
      options.worlds, 0, "worlds", "DIR",
      "Worlds to simulate: a folder of .ini files, one file, or none; default config/worlds");
  line.option(options.folder, 'o', "output", "OUTDIR",
              "Folder for recordings and tables; default suite");
  line.flag(options.reuse, 0, "reuse",
            "Reuse recordings in OUTDIR that were simulated with the same parameters; others in "
            "it, and the tables, are overwritten");
  addJobOptions(line, options);
  line.option(options.kitti, 0, "kitti", "DIR",
              "KITTI tracking benchmark, whose sequences are evaluated too");
  line.option(options.degrade, 0, "degrade", "FILE.ini",
              "Also evaluate positions on degraded KITTI boxes, seeds 1 to 5");
  line.parameters(params);
  if (!options.outputs.parse(line, argc, argv, {&options.degrade})) return false;
  checkTogether(options);
  options.worlds = program::findDataFile(options.worlds);
  options.degrade = program::findDataFile(options.degrade);
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
  explicit Suite(const SuiteOptions& options)
      : options_(options),
        progress_("suite", options.outputs.quiet() || options.jobs > 0),
        files_(worldFiles(options.worlds)),
        worlds_(worldSources(files_)) {
    max_frames_ = options.frames;
    if (options.quick) max_frames_ = kQuickFrames;
    for (auto& source : worlds_) {
      source.rate_hz = options.rate_hz;
      total_ += (1 + rejectionsFor(source).size()) * framesOf(source, max_frames_);
    }
  }

  /// Simulates and replays, and stores the runs.
  void storeRuns() {
    for (const auto& source : worlds_) {
      const World world = recordedWorld(source);
      const auto runs = replayed(world, source, 1);
      if (program::interrupted()) return;
      writeRuns(world, textOf(options_.perception), runs);
    }
  }

  [[nodiscard]] std::vector<SuiteEntry> run() {
    if (options_.jobs > 0 && !files_.empty()) {
      runWorldJobs({files_, options_.folder, max_frames_, options_.jobs, options_.profile,
                    options_.outputs.quiet()},
                   options_.perception);
    }
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

  [[nodiscard]] bool frameDone() {
    const std::lock_guard lock(progress_mutex_);
    ++done_;
    progress_.update(done_, static_cast<double>(done_) / static_cast<double>(total_));
    return !program::interrupted();
  }

  /// The world's recording: simulated, or the one that exists.
  World recordedWorld(const WorldSource& source) {
    if (options_.reuse || options_.jobs > 0) {
      if (auto existing = existingWorld(source, options_.folder, max_frames_)) {
        done_ += existing->frames;
        return *existing;
      }
    }
    return simulateWorld(source, options_.folder, max_frames_, [this] { return frameDone(); });
  }

  /// One run for each kind of rejection.
  std::vector<WorldRun> replayed(const World& world, const WorldSource& source,
                                 std::size_t threads) {
    if (program::interrupted()) return {};
    std::vector<pipeline::PerceptionParams> params;
    for (const auto& kind : rejectionsFor(source)) {
      params.push_back(options_.perception);
      params.back().slam.dynamic_rejection = kind.value;
    }
    return runWorld(
        world, params, [this] { return frameDone(); }, threads);
  }

  void evaluateWorld(const WorldSource& source) {
    const World world = recordedWorld(source);
    const std::size_t processors = std::max(1U, std::thread::hardware_concurrency());
    const auto kinds = rejectionsFor(source);
    const auto runs = options_.jobs > 0 ? readRuns(world, textOf(options_.perception))
                                        : replayed(world, source, processors);
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
    io::DegradeParams degrade;
    Params params;
    degrade.describe(params.section("degrade").user());
    params.loadFile(options_.degrade);
    for (int seed = 1; seed <= 5 && !program::interrupted(); ++seed) {
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

  const SuiteOptions& options_;
  program::Progress progress_;
  std::mutex progress_mutex_;
  std::vector<std::string> files_;
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
  SuiteOptions options;
  if (!parseSuite(options, argc, argv)) return program::kDone;
  program::catchInterrupts();
  Suite suite(options);
  fs::create_directories(options.folder);
  if (options.only_runs) {
    suite.storeRuns();
    return program::kDone;
  }
  const auto entries = suite.run();
  OutputFile file(fs::path(options.folder) / "suite.md");
  writeSuite(file.stream(), entries);
  file.commit();
  if (!options.outputs.quiet()) writeSuite(std::cout, entries);
  options.outputs.write([&] { return suiteFigures(entries); }, [&] { return suitePlot(entries); });
  return program::kDone;
}

}  // namespace headway::app
