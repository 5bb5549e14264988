// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/pipeline/perception.h>

#include <optional>
#include <string>
#include <vector>

namespace headway::app {

/// Worlds that headway-fleet simulates and replays, a job each.
struct WorldJobs {
  std::vector<std::string> worlds;  ///< .ini files
  std::string folder;               ///< of recordings and runs, as of the suite
  std::optional<std::size_t> max_frames;
  int at_once = 1;      ///< cores here, or jobs with a profile
  std::string profile;  ///< of Snakemake; empty: here
  bool quiet = false;
};

/// Runs all jobs by the headway-fleet beside this program; those whose results exist are not run
/// again. The parameters are written to `suite.ini` in the folder.
///
/// @throws InputError if headway-fleet is missing or a job failed, which it reports itself
void runWorldJobs(const WorldJobs& jobs, const pipeline::PerceptionParams& perception);

/// Parameters as text.
[[nodiscard]] std::string textOf(pipeline::PerceptionParams perception);

}  // namespace headway::app
