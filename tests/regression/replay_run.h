// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/trajectory_error.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace headway::test {

/// A replay that was run to its end.
struct ReplayRun {
  ProcessResult process;
  std::filesystem::path folder;
  nlohmann::json summary;  ///< null where there is none

  [[nodiscard]] std::string file(const std::string& name) const { return folder / name; }
};

/// Runs headway-replay, without pictures unless `options` ask for them.
inline ReplayRun replay(const std::filesystem::path& rawlog, const std::filesystem::path& folder,
                        const std::string& options = "--snapshots 0") {
  ReplayRun run;
  run.folder = folder;
  run.process = runProcess(program("headway-replay") + " -i " + rawlog.string() + " -o " +
                           folder.string() + " " + options);
  const std::string text = contentsOf(run.file("summary.json"));
  if (!text.empty()) run.summary = nlohmann::json::parse(text);
  return run;
}

/// RMSE of the positions after rigid alignment, poses paired by time [m].
inline double ateRmse(const std::vector<Stamped<Pose>>& truth,
                      const std::vector<Stamped<Pose>>& estimate) {
  return eval::trajectoryError(eval::pairByTime(truth, estimate, 0.02), {}).ate_m.rmse;
}

}  // namespace headway::test
