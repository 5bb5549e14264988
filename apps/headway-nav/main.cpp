// SPDX-License-Identifier: BSD-3-Clause
// headway-nav: trials of a robot among people, driven by each policy of obstacles.
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway/program/picture_files.h>
#include <headway/program/progress.h>

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

#include "policy_figures.h"
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

/// Writes `FOLDER/trial_NNNN.mp4` and `FOLDER/trial_NNNN.png` of one trial, all policies side
/// by side. Without an encoder, the video is a folder of numbered pictures.
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

  const int count = static_cast<int>((endOf(records) + 1.0) * kPicturesPerSecond);
  const cv::Size size = drawMoment(records, robot, 0.0).size();
  program::VideoOutput video(name + ".mp4", kPicturesPerSecond, size, true,
                             [](const std::string&) {});  // the returned path shows it
  for (int i = 0; i < count; ++i) video.add(drawMoment(records, robot, i / kPicturesPerSecond));
  video.finish();
  return {name + ".png", video.path()};
}

struct Options {
  int trials = 20;
  std::string policy = "all";
  int seed = 1;
  std::string json;
  std::string video;
  std::string filmed = "1";
  std::string worst;  ///< picture of the worst trial; empty: none
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

/// Runs one trial with each policy.
///
/// @param record  keep the planning steps, for pictures
/// @return        one record for each policy
std::vector<TrialRecord> runTrial(const std::vector<std::unique_ptr<TrialRunner>>& runners,
                                  std::vector<PolicyTrials>& policies, std::uint64_t seed,
                                  bool record) {
  std::vector<TrialRecord> records;
  for (std::size_t p = 0; p < policies.size(); ++p) {
    TrialRecord& trial = records.emplace_back();
    TrialObserver observer;
    if (record) observer = [&](const TrialMoment& moment) { trial.moments.push_back(moment); };
    trial.result = runners[p]->run(seed, observer);
    trial.policy = nameOf(policies[p].policy);
    policies[p].trials.push_back(trial.result);
  }
  return records;
}

void report(const Options& options, const std::vector<PolicyTrials>& policies,
            const std::vector<std::string>& written) {
  const auto figures = figuresOf(policies);
  if (!options.quiet) {
    print(std::cout, figures);
    for (const auto& file : written) std::cout << "wrote " << file << '\n';
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
  line.option(options.worst, 0, "worst", "FILE.png",
              "Draw the worst trial: most collisions, then goals not reached, then least "
              "distance");
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
void writeWorst(const Options& options, const TrialSetup& setup,
                const std::vector<std::unique_ptr<TrialRunner>>& runners,
                const std::vector<PolicyTrials>& driven) {
  if (options.worst.empty() || driven.front().trials.empty()) return;
  const std::uint64_t seed = worstSeed(driven);
  auto policies = driven;
  const auto records = runTrial(runners, policies, seed, true);
  program::writePicture(options.worst, drawWhole(records, setup.world.robot));
  if (!options.quiet) {
    std::cout << "wrote " << options.worst << ": the worst trial, seed " << seed << '\n';
  }
}

int runAll(const Options& options, TrialSetup setup) {
  std::vector<PolicyTrials> policies;
  std::vector<std::unique_ptr<TrialRunner>> runners;
  for (const auto policy : chosenPolicies(options.policy)) {
    policies.push_back({policy, {}});
    setup.nav.policy = policy;
    runners.push_back(std::make_unique<TrialRunner>(setup));
  }
  const auto filmed = filmedTrials(options.filmed);
  std::vector<std::string> written;
  program::catchInterrupts();
  program::Progress progress("trials", options.quiet);
  for (int i = 0; i < options.trials && !program::interrupted(); ++i) {
    const auto seed = static_cast<std::uint64_t>(options.seed + i);
    const bool film = !options.video.empty() && filmed.count(i + 1) > 0;
    const auto records = runTrial(runners, policies, seed, film);
    if (film) {
      for (const auto& file :
           writeRecording(records, setup.world.robot, options.seed + i, options.video)) {
        written.push_back(file);
      }
    }
    progress.update(static_cast<std::size_t>(i + 1), (i + 1.0) / options.trials);
  }
  progress.finish();
  report(options, policies, written);
  writeWorst(options, setup, runners, policies);
  return program::kDone;
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
    app::requireWritable(options);
    // The predictive obstacles need the parameters of the simulated robot.
    setup.nav.robot.radius_m = setup.world.robot.radius();
    setup.nav.robot.length_m = setup.world.robot.length_m;
    setup.nav.robot.width_m = setup.world.robot.width_m;
    setup.nav.robot.max_speed_mps = setup.world.robot.max_speed_mps;
    setup.nav.governor.lag_s = setup.world.robot.lag_s;
    return app::runAll(options, setup);
  });
}
