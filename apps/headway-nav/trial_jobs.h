// SPDX-License-Identifier: BSD-3-Clause
// Trials side by side in several processes.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "trial.h"

namespace headway::app {

/// One trial with each policy.
struct TrialOutcome {
  std::vector<TrialResult> results;  ///< by policy
  std::vector<std::string> written;  ///< files
};

/// Runs trials 0 to count - 1 in as many processes as `jobs`, because MRPT's clock is one of a
/// process; in this one if there is one job.
///
/// @param start  called once in each process; returns what runs a trial there
/// @param done   called here after each trial with the number of finished ones
/// @return       by trial; fewer after an interrupt, none missing before the last one
/// @throws InputError with the text of what failed in a process
[[nodiscard]] std::vector<TrialOutcome> runTrials(
    int jobs, std::size_t count,
    const std::function<std::function<TrialOutcome(std::size_t)>()>& start,
    const std::function<void(std::size_t)>& done);

}  // namespace headway::app
