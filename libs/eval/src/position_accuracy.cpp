#include "position_accuracy.h"

#include <algorithm>

namespace headway::eval {
namespace {

std::optional<double> errorOf(const ClassFrame& frame, const CandidatePair& pair) {
  for (std::size_t k = 0; k < frame.positions.size(); ++k) {
    const auto& candidate = frame.positions[k];
    if (candidate.row == pair.row && candidate.column == pair.column) {
      return frame.position_errors_m[k];
    }
  }
  return std::nullopt;
}

}  // namespace

void PositionCounts::add(const PositionCounts& other) {
  tp += other.tp;
  fp += other.fp;
  fn += other.fn;
  measured += other.measured;
  squared_sum_m2 += other.squared_sum_m2;
}

PositionCounts positionCounts(const ClassSequence& sequence) {
  PositionCounts counts;
  for (const auto& frame : sequence.frames) {
    std::vector<bool> paired(frame.estimates.size(), false);
    std::size_t found = 0;
    for (const auto& pair : assignPairs(frame.positions)) {
      paired[pair.column] = true;
      if (frame.truth[pair.row].ignored) continue;
      ++found;
      const auto error = errorOf(frame, pair);
      if (!error) continue;
      ++counts.measured;
      counts.squared_sum_m2 += *error * *error;
    }
    counts.tp += found;
    counts.fn += static_cast<std::size_t>(std::count_if(frame.truth.begin(), frame.truth.end(),
                                                        [](const auto& t) { return !t.ignored; })) -
                 found;
    for (std::size_t j = 0; j < frame.estimates.size(); ++j) {
      if (!paired[j] && !frame.estimates[j].harmless) ++counts.fp;
    }
  }
  return counts;
}

}  // namespace headway::eval
