#include "clear_mot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::eval {
namespace {

constexpr int kRecalls = 40;

/// Match history of one true object.
struct History {
  int last_track = FrameMatches::kNone;  ///< of its latest match
  bool interrupted = false;
};

void countTruth(const TrueBox& truth, int estimated_track, History& history, ClearCounts& counts) {
  if (truth.ignored) {
    history = {};
    return;
  }
  if (estimated_track == FrameMatches::kNone) {
    ++counts.fn;
    history.interrupted = true;
    return;
  }
  const bool matched_before = history.last_track != FrameMatches::kNone;
  if (matched_before && history.last_track != estimated_track) ++counts.idsw;
  if (matched_before && history.interrupted) ++counts.frag;
  history = {estimated_track, false};
}

void countFrame(const ClassFrame& frame, const FrameMatches& matches,
                std::vector<History>& histories, ClearCounts& counts) {
  for (std::size_t i = 0; i < frame.truth.size(); ++i) {
    const int j = matches.estimate_of[i];
    const bool matched = j != FrameMatches::kNone;
    const int track = matched ? frame.estimates[static_cast<std::size_t>(j)].track : j;
    countTruth(frame.truth[i], track, histories[static_cast<std::size_t>(frame.truth[i].track)],
               counts);
    if (!matched || frame.truth[i].ignored) continue;
    ++counts.tp;
    counts.true_scores.push_back(frame.estimates[static_cast<std::size_t>(j)].score);
  }
  for (const auto& pair : frame.overlaps) {
    const bool is_match = matches.estimate_of[pair.row] == static_cast<int>(pair.column);
    if (is_match && !frame.truth[pair.row].ignored) counts.overlap_sum += 1.0 - pair.cost;
  }
  for (std::size_t j = 0; j < frame.estimates.size(); ++j) {
    if (matches.truth_of[j] == FrameMatches::kNone && !frame.estimates[j].ignored_if_unmatched)
      ++counts.fp;
  }
}

/// Score threshold at which the given ratio of the truth is matched; nullopt if it cannot be.
std::optional<double> thresholdFor(double recall, std::size_t truth,
                                   const std::vector<double>& descending_scores) {
  const auto needed =
      static_cast<std::size_t>(std::ceil(recall * static_cast<double>(truth) - 1e-9));
  if (needed > descending_scores.size()) return std::nullopt;
  return descending_scores[std::max<std::size_t>(needed, 1) - 1];
}

double scaledMota(const ClearCounts& counts, double recall) {
  const auto truth = static_cast<double>(counts.truth());
  const double avoidable = static_cast<double>(counts.errors()) - (1.0 - recall) * truth;
  return std::clamp(1.0 - avoidable / (recall * truth), 0.0, 1.0);
}

}  // namespace

double ClearCounts::mota() const {
  return 1.0 - static_cast<double>(errors()) / static_cast<double>(truth());
}

void ClearCounts::add(const ClearCounts& other) {
  tp += other.tp;
  fp += other.fp;
  fn += other.fn;
  idsw += other.idsw;
  frag += other.frag;
  overlap_sum += other.overlap_sum;
  true_scores.insert(true_scores.end(), other.true_scores.begin(), other.true_scores.end());
}

ClearCounts clearCounts(const std::vector<ClassSequence>& sequences, double min_overlap,
                        double score_threshold) {
  ClearCounts counts;
  for (const auto& sequence : sequences) {
    FrameMatcher matcher(sequence, min_overlap, score_threshold);
    std::vector<History> histories(static_cast<std::size_t>(sequence.true_tracks));
    for (const auto& frame : sequence.frames) {
      countFrame(frame, matcher.match(frame), histories, counts);
    }
  }
  return counts;
}

std::optional<ClearCurve> clearCurve(const std::vector<ClassSequence>& sequences,
                                     double min_overlap) {
  ClearCurve curve;
  curve.best_threshold = -std::numeric_limits<double>::infinity();
  curve.best = clearCounts(sequences, min_overlap, curve.best_threshold);
  const std::size_t truth = curve.best.truth();
  if (truth == 0) return std::nullopt;
  auto scores = curve.best.true_scores;
  std::sort(scores.begin(), scores.end(), std::greater<>());
  for (int k = 1; k <= kRecalls; ++k) {
    const double recall = static_cast<double>(k) / kRecalls;
    const auto threshold = thresholdFor(recall, truth, scores);
    if (!threshold) break;
    auto counts = clearCounts(sequences, min_overlap, *threshold);
    const RecallPoint point{recall, *threshold, counts.mota(), scaledMota(counts, recall)};
    curve.points.push_back(point);
    curve.amota += point.mota / kRecalls;
    curve.samota += point.smota / kRecalls;
    if (point.mota > curve.best.mota()) {
      curve.best = std::move(counts);
      curve.best_threshold = *threshold;
    }
  }
  return curve;
}

}  // namespace headway::eval
