#include <headway/core/stage_times.h>
#include <headway/core/statistics.h>

namespace headway {

void StageTimes::add(const std::string& stage, double milliseconds) {
  samples_[stage].push_back(milliseconds);
}

void StageTimes::merge(const StageTimes& other) {
  for (const auto& [stage, values] : other.samples_) {
    auto& mine = samples_[stage];
    mine.insert(mine.end(), values.begin(), values.end());
  }
}

std::map<std::string, StageTimes::Summary> StageTimes::summary() const {
  std::map<std::string, Summary> result;
  for (const auto& [stage, values] : samples_) {
    result[stage] = {values.size(), percentile(values, 0.5), percentile(values, 0.95),
                     percentile(values, 1.0)};
  }
  return result;
}

}  // namespace headway
