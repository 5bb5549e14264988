// SPDX-License-Identifier: BSD-3-Clause
// headway-nav: trials of a robot among people, driven by each policy of obstacles.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/core/text.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway/program/picture_files.h>
#include <headway/program/progress.h>
#include <headway/sim/rigs.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "drive.h"
#include "policy_figures.h"
#include "trial_jobs.h"
#include "trial_pictures.h"

namespace headway::app {

namespace {

constexpr double kPicturesPerSecond = 20.0;

double endOf(const std::vector<TrialRecord>& records) {
  double end_s = 0.0;
  for (const auto& record : records) end_s = std::max(end_s, record.moments.back().time_s);
  return end_s;
}

/// Path of a trial's files without their endings: `FOLDER/trial_NNNN`.
std::string recordingName(const std::string& folder, int seed) {
  return folder + cv::format("/trial_%04d", seed);
}

/// Writes a video of one trial, all policies side by side. Without an encoder, it is a folder of
/// numbered pictures.
///
/// @return          path of what was written
std::string writeVideo(const std::vector<TrialRecord>& records, const RobotParams& robot,
                       const std::string& path) {
  const int count = static_cast<int>((endOf(records) + 1.0) * kPicturesPerSecond);
  const cv::Size size = drawMoment(records, robot, 0.0).size();
  program::VideoOutput video(path, kPicturesPerSecond, size, true,
                             [](const std::string&) {});  // the returned path shows it
  for (int i = 0; i < count; ++i) video.add(drawMoment(records, robot, i / kPicturesPerSecond));
  video.finish();
  return video.path();
}

/// Writes `FOLDER/trial_NNNN.mp4` and `FOLDER/trial_NNNN.png` of one trial.
///
/// @return          the files written
/// @throws InputError if the folder cannot be written
std::vector<std::string> writeRecording(const std::vector<TrialRecord>& records,
                                        const RobotParams& robot, int seed,
                                        const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw InputError(folder + ": cannot be created (" + failed.message() + ")");
  const std::string name = recordingName(folder, seed);
  program::writePicture(name + ".png", drawWhole(records, robot));
  return {name + ".png", writeVideo(records, robot, name + ".mp4")};
}

bool isVideo(const std::string& path) { return std::filesystem::path(path).extension() == ".mp4"; }

struct Options {
  int trials = 20;
  std::string policy = "all";
  int seed = 1;
  std::string json;
  std::string video;
  std::string filmed = "1";
  std::string worst;  ///< picture or video of the worst trial; empty: none
  std::string world;  ///< name or file; empty: abstract scenes
  std::string rig;    ///< empty: the world's
  std::string sense;  ///< empty: images in a world, else detections
  std::string layer;  ///< empty: local
  int jobs = 1;
  bool overwrite = false;
  bool quiet = false;
};

std::vector<nav::ObstaclePolicy> chosenPolicies(const std::string& name) {
  std::vector<nav::ObstaclePolicy> chosen;
  for (const auto& [spelling, policy] : nav::obstaclePolicies()) {
    if (name == "all" || name == spelling) chosen.push_back(policy);
  }
  if (chosen.empty()) {
    throw program::UsageError("--policy: '" + name + "' is none of static, sweep, time_gated, all");
  }
  return chosen;
}

/// Numbers of the trials to be filmed, from 1.
std::set<int> filmedTrials(const std::string& list) {
  std::set<int> trials;
  for (const std::string& word : program::split(list)) {
    char* end = nullptr;
    const long trial = std::strtol(word.c_str(), &end, 10);
    if (word.empty() || *end != '\0' || trial < 1) {
      throw program::UsageError("--film: '" + word + "' is not the number of a trial");
    }
    trials.insert(static_cast<int>(trial));
  }
  return trials;
}

/// Checks all output files before the work starts.
void requireWritable(const Options& options) {
  for (const auto& file : {options.json, options.worst}) {
    if (!file.empty()) program::requireWritable(file, options.overwrite);
  }
  if (options.video.empty()) return;
  for (const int trial : filmedTrials(options.filmed)) {
    const auto name = recordingName(options.video, options.seed + trial - 1);
    program::requireWritable(name + ".png", options.overwrite);
    program::requireWritable(name + ".mp4", options.overwrite);
    program::requireWritable(name + "_frames", options.overwrite);
  }
}

/// What runs trials with each of the chosen policies.
using Runners = std::vector<std::unique_ptr<Trials>>;

Runners makeRunners(const Options& options, TrialSetup setup, DriveSetup drive) {
  Runners runners;
  for (const auto policy : chosenPolicies(options.policy)) {
    setup.nav.policy = drive.nav.policy = policy;
    if (options.world.empty()) {
      runners.push_back(std::make_unique<TrialRunner>(setup));
    } else {
      runners.push_back(std::make_unique<DriveRunner>(drive));
    }
  }
  return runners;
}

/// Runs one trial with each policy.
///
/// @param record  keep the planning steps, for pictures
/// @return        one record for each policy
std::vector<TrialRecord> runTrial(const Options& options, const Runners& runners,
                                  std::uint64_t seed, bool record) {
  std::vector<TrialRecord> records;
  const auto policies = chosenPolicies(options.policy);
  for (std::size_t p = 0; p < policies.size(); ++p) {
    TrialRecord& trial = records.emplace_back();
    TrialObserver observer;
    if (record) observer = [&](const TrialMoment& moment) { trial.moments.push_back(moment); };
    trial.result = runners[p]->run(seed, observer);
    trial.policy = nameOf(policies[p]);
  }
  return records;
}

void report(const Options& options, const std::vector<PolicyTrials>& policies,
            const std::vector<std::string>& written) {
  const auto figures = figuresOf(policies);
  if (!options.quiet) {
    print(std::cout, figures);
    for (const auto& file : written) std::cout << "wrote " << printable(file) << '\n';
  }
  if (!options.json.empty()) writeFile(options.json, toJson(figures).dump(2) + "\n");
}

/// Declares the options.
void describe(Options& options, program::CommandLine& line) {
  line.option(options.trials, 0, "trials", "N", "Number of trials; default 20");
  line.option(options.policy, 0, "policy", "NAME|all", "static, sweep, time_gated or all");
  line.option(options.seed, 0, "seed", "S",
              "Seed of the first trial; it increases by one per trial");
  line.option(options.json, 0, "json", "FILE", "Write the figures as JSON");
  line.option(options.video, 0, "video", "DIR", "Write videos and top views of filmed trials");
  line.option(options.filmed, 0, "film", "N,N,...", "Trials to be filmed, from 1; default 1");
  line.option(options.worst, 0, "worst", "FILE.png|FILE.mp4",
              "Draw or film the worst trial: most collisions, then goals not reached, then least "
              "distance");
  line.option(options.world, 0, "world", "hall|campus|warehouse|yard-loop|FILE.ini",
              "Drive through a simulated world, on a course of 15 to 30 m past people");
  line.option(options.rig, 0, "rig", "NAME",
              "Rig instead of the world's: robot, small or rgbd (depth camera)");
  line.option(options.sense, 0, "sense", "images|truth|detections",
              "By what the robot drives: its rendered images (default with --world), true tracks "
              "and grid, or a simulated detector (default without)");
  line.option(options.layer, 0, "layer", "local|map",
              "Obstacles of a robot that drives by images: what each frame shows (default), or the "
              "map's alone");
  line.option(options.jobs, 0, "jobs", "N",
              "Trials at the same time, each in a process; default 1");
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite files that exist");
}

/// Whether the program was called with nothing that selects trials or outputs.
bool isWithoutArguments(int argc, const char* const* argv) {
  static const std::set<std::string> kKept = {"-q", "--quiet", "-w", "--overwrite", "-qw", "-wq"};
  return std::all_of(argv + 1, argv + argc, [](const char* word) { return kKept.count(word) > 0; });
}

/// Seed of the trial with the most collisions, then unfinished policies, then the least distance.
std::uint64_t worstSeed(const std::vector<PolicyTrials>& policies) {
  using Badness = std::tuple<int, int, double>;
  std::map<std::uint64_t, Badness> trials;
  for (const auto& policy : policies) {
    for (const auto& trial : policy.trials) {
      auto& [collisions, unfinished, closeness] = trials[trial.seed];
      collisions += trial.collided ? 1 : 0;
      unfinished += trial.goal_reached ? 0 : 1;
      closeness = std::max(closeness, 1.0 / (1.0 + trial.min_distance_m));
    }
  }
  return std::max_element(trials.begin(), trials.end(),
                          [](const auto& a, const auto& b) { return a.second < b.second; })
      ->first;
}

/// Drives the worst trial again, for its picture.
void writeWorst(const Options& options, const Runners& runners, const RobotParams& robot,
                const std::vector<PolicyTrials>& driven) {
  if (options.worst.empty() || driven.front().trials.empty()) return;
  const std::uint64_t seed = worstSeed(driven);
  const auto records = runTrial(options, runners, seed, true);
  std::string path = options.worst;
  if (isVideo(path)) {
    path = writeVideo(records, robot, path);
  } else {
    program::writePicture(path, drawWhole(records, robot));
  }
  if (!options.quiet) {
    std::cout << "wrote " << printable(path) << ": the worst trial, seed " << seed << '\n';
  }
}

int runAll(const Options& options, const TrialSetup& setup, const DriveSetup& drive) {
  const auto filmed = filmedTrials(options.filmed);
  const RobotParams& robot = setup.world.robot;
  const auto start = [&]() -> std::function<TrialOutcome(std::size_t)> {
    const auto runners = std::make_shared<Runners>(makeRunners(options, setup, drive));
    return [&, runners](std::size_t i) {
      const int seed = options.seed + static_cast<int>(i);
      const bool film = !options.video.empty() && filmed.count(static_cast<int>(i) + 1) > 0;
      const auto records = runTrial(options, *runners, static_cast<std::uint64_t>(seed), film);
      TrialOutcome outcome;
      for (const auto& record : records) outcome.results.push_back(record.result);
      if (film) outcome.written = writeRecording(records, robot, seed, options.video);
      return outcome;
    };
  };
  program::catchInterrupts();
  program::Progress progress("trials", options.quiet);
  const auto outcomes = runTrials(
      options.jobs, static_cast<std::size_t>(options.trials), start,
      [&](std::size_t done) { progress.update(done, static_cast<double>(done) / options.trials); });
  progress.finish();
  std::vector<PolicyTrials> policies;
  std::vector<std::string> written;
  for (const auto policy : chosenPolicies(options.policy)) policies.push_back({policy, {}});
  for (const TrialOutcome& outcome : outcomes) {
    for (std::size_t p = 0; p < policies.size(); ++p) {
      policies[p].trials.push_back(outcome.results[p]);
    }
    written.insert(written.end(), outcome.written.begin(), outcome.written.end());
  }
  report(options, policies, written);
  if (!options.worst.empty()) {
    writeWorst(options, makeRunners(options, setup, drive), robot, policies);
  }
  return program::kDone;
}

/// The world that is named, with the rig that is.
void loadWorld(const Options& options, DriveSetup& drive) {
  if (options.world.empty()) {
    if (!options.rig.empty()) throw program::UsageError("--rig: needs --world");
    if (drive.sense != Sense::kDetections) throw program::UsageError("--sense: needs --world");
    return;
  }
  if (drive.sense == Sense::kDetections) {
    throw program::UsageError("--sense detections: is for scenes without --world");
  }
  Params params;
  drive.world.describe(params);
  const bool is_file = std::filesystem::path(options.world).extension() == ".ini";
  params.loadFile(is_file ? options.world
                          : program::findDataFile("config/worlds/" + options.world + ".ini"));
  if (!options.rig.empty()) sim::applyRig(options.rig, drive.world.camera);
  drive.world.camera.colour = false;  // perception does without, and is faster
}

/// Whether a robot that drives by images has the local layer.
bool hasLocalLayer(const Options& options, Sense sense) {
  if (options.layer.empty()) return true;
  if (sense != Sense::kImages) throw program::UsageError("--layer: needs --sense images");
  if (options.layer != "local" && options.layer != "map") {
    throw program::UsageError("--layer: '" + options.layer + "' is none of local, map");
  }
  return options.layer == "local";
}

/// Where the robot's knowledge comes from.
Sense chosenSense(const Options& options) {
  if (options.sense.empty()) return options.world.empty() ? Sense::kDetections : Sense::kImages;
  for (const auto& [name, sense] : senses()) {
    if (name == options.sense) return sense;
  }
  throw program::UsageError("--sense: '" + options.sense +
                            "' is none of images, truth, detections");
}

}  // namespace
}  // namespace headway::app

int main(int argc, char** argv) {
  using namespace headway;
  return program::run("headway-nav", [&] {
    app::Options options;
    app::TrialSetup setup;
    Params params;
    setup.world.describe(params);
    setup.nav.describe(params.section("nav"));
    setup.objects.describe(params.section("objects"));
    program::CommandLine line("headway-nav",
                              "Drives a simulated robot among people. Without arguments: 20 trials "
                              "of all policies with seed 1, and a picture of the worst one.");
    app::describe(options, line);
    line.parameters(params);
    if (!line.parse(argc, argv)) return program::kDone;
    options.quiet = line.quiet();
    if (app::isWithoutArguments(argc, argv)) {
      options.worst = "nav-worst.png";
      if (!options.quiet) {
        std::cout << "headway-nav --trials 20 --policy all --seed 1 --worst nav-worst.png"
                  << std::endl;
      }
    }
    if (options.trials < 1) throw program::UsageError("--trials: must be at least 1");
    if (options.seed < 0) throw program::UsageError("--seed: must not be negative");
    if (options.jobs < 1) throw program::UsageError("--jobs: must be at least 1");
    app::requireWritable(options);
    app::DriveSetup drive;
    drive.sense = app::chosenSense(options);
    drive.local_layer = app::hasLocalLayer(options, drive.sense);
    app::loadWorld(options, drive);
    // The predictive obstacles need the parameters of the simulated robot.
    setup.nav.robot.radius_m = setup.world.robot.radius();
    setup.nav.robot.length_m = setup.world.robot.length_m;
    setup.nav.robot.width_m = setup.world.robot.width_m;
    setup.nav.robot.max_speed_mps = setup.world.robot.max_speed_mps;
    setup.nav.governor.lag_s = setup.world.robot.lag_s;
    if (!options.world.empty()) {
      setup.nav.robot.acceleration_mps2 = drive.world.robot.acceleration_mps2;
    }
    drive.robot = setup.world.robot;
    drive.nav = setup.nav;
    drive.objects = setup.objects;
    return app::runAll(options, setup, drive);
  });
}
