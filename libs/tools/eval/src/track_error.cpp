// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/track_error.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "clear_mot.h"
#include "hota.h"

namespace headway::eval {
namespace {

/// Correct and wrong positions, whatever the score.
struct PositionCounts {
  std::size_t tp = 0, fp = 0, fn = 0;
  std::size_t measured = 0;     ///< true positives with a known distance
  double squared_sum_m2 = 0.0;  ///< of their distances on the ground

  void add(const PositionCounts& other) {
    tp += other.tp;
    fp += other.fp;
    fn += other.fn;
    measured += other.measured;
    squared_sum_m2 += other.squared_sum_m2;
  }
};

std::optional<double> errorOf(const ClassFrame& frame, const CandidatePair& pair) {
  for (std::size_t k = 0; k < frame.positions.size(); ++k) {
    const auto& candidate = frame.positions[k];
    if (candidate.row == pair.row && candidate.column == pair.column) {
      return frame.position_errors_m[k];
    }
  }
  return std::nullopt;
}

/// Pairs estimates with truth by position, frame by frame.
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
      if (!paired[j] && !frame.estimates[j].ignored_if_unmatched) ++counts.fp;
    }
  }
  return counts;
}

/// All counts of one class, or of several classes together.
struct ClassCounts {
  PositionCounts positions;
  ClearCounts clear;
  HotaCounts hota;

  void add(const ClassCounts& other) {
    positions.add(other.positions);
    clear.add(other.clear);
    hota.add(other.hota);
  }
};

std::optional<double> ratio(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

void fillPositions(const PositionCounts& counts, TrackError& result) {
  result.precision = ratio(counts.tp, counts.tp + counts.fp);
  result.recall = ratio(counts.tp, counts.tp + counts.fn);
  result.f1 = ratio(2 * counts.tp, 2 * counts.tp + counts.fp + counts.fn);
  if (counts.measured > 0) {
    result.rmse_m = std::sqrt(counts.squared_sum_m2 / static_cast<double>(counts.measured));
  }
}

TrackError figuresOf(const ClassCounts& counts) {
  TrackError result;
  fillPositions(counts.positions, result);
  const auto& clear = counts.clear;
  result.truth_boxes = clear.truth();
  result.tp = clear.tp;
  result.fp = clear.fp;
  result.fn = clear.fn;
  result.idsw = clear.idsw;
  result.frag = clear.frag;
  if (clear.tp > 0) result.motp = clear.overlap_sum / static_cast<double>(clear.tp);
  if (clear.truth() == 0) return result;
  result.mota = clear.mota();
  const auto hota = hotaOf(counts.hota);
  result.hota = hota.hota;
  result.deta = hota.deta;
  result.assa = hota.assa;
  return result;
}

/// Evaluates one class and adds its counts to `all`.
TrackError classError(const std::vector<LabelledSequence>& sequences, ObjectClass object_class,
                      const TrackErrorParams& params, ClassCounts& all) {
  std::vector<ClassSequence> prepared;
  for (const auto& sequence : sequences) {
    prepared.push_back(classSequence(sequence, object_class, params));
  }
  ClassCounts counts;
  for (const auto& sequence : prepared) counts.positions.add(positionCounts(sequence));
  if (params.positions_only) {
    all.add(counts);
    return figuresOf(counts);
  }
  const auto curve = clearCurve(prepared, params.min_overlap);
  const double threshold = curve ? curve->best_threshold : -std::numeric_limits<double>::infinity();
  counts.clear = curve ? curve->best : clearCounts(prepared, params.min_overlap, threshold);
  for (const auto& sequence : prepared) {
    counts.hota.add(hotaCounts(sequence, params.min_overlap, threshold));
  }
  all.add(counts);
  auto result = figuresOf(counts);
  if (!curve) return result;
  if (std::isfinite(threshold)) result.score_threshold = threshold;
  result.samota = curve->samota;
  result.amota = curve->amota;
  result.curve = curve->points;
  return result;
}

/// Mean over the classes with a value.
std::optional<double> meanOf(const std::map<ObjectClass, TrackError>& classes,
                             std::optional<double> TrackError::*figure) {
  double sum = 0.0;
  std::size_t count = 0;
  for (const auto& [object_class, error] : classes) {
    if (!(error.*figure)) continue;
    sum += *(error.*figure);
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / static_cast<double>(count);
}

}  // namespace

TrackErrors trackErrors(const std::vector<LabelledSequence>& sequences,
                        const TrackErrorParams& params) {
  TrackErrors result;
  ClassCounts all;
  for (const auto object_class : params.classes) {
    result.classes[object_class] = classError(sequences, object_class, params, all);
  }
  result.all = figuresOf(all);
  result.all.samota = meanOf(result.classes, &TrackError::samota);
  result.all.amota = meanOf(result.classes, &TrackError::amota);
  return result;
}

}  // namespace headway::eval
