// SPDX-License-Identifier: BSD-3-Clause
// Durations of the stages of a frame, and processor time.
#include <headway/core/stage_times.h>

#include <ctime>

namespace headway {

double processorSeconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

void StageTimes::add(const std::string& stage, double milliseconds) {
  stages_[stage].add(milliseconds);
}

void StageTimes::merge(const StageTimes& other) {
  for (const auto& [stage, times] : other.stages_) stages_[stage].merge(times);
}

std::map<std::string, StageTimes::Summary> StageTimes::summary() const {
  std::map<std::string, Summary> result;
  for (const auto& [stage, times] : stages_) {
    result[stage] = {times.count(), times.percentile(0.5), times.percentile(0.95), times.max(),
                     times.sum()};
  }
  return result;
}

}  // namespace headway
