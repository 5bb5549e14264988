// SPDX-License-Identifier: BSD-3-Clause
#include "suite_jobs.h"

#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <sstream>

namespace headway::app {
namespace {

namespace fs = std::filesystem;

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

}  // namespace

std::string textOf(pipeline::PerceptionParams perception) {
  Params params;
  perception.describe(params);
  std::ostringstream text;
  params.print(text);
  return text.str();
}

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

}  // namespace headway::app
