// SPDX-License-Identifier: BSD-3-Clause
#include "clear_mot.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace headway::eval {
namespace {

constexpr int kRecalls = 40;

/// Track of a true object's latest match, or kNone.
using LatestTracks = std::vector<int>;

void countTruth(const TrueBox& truth, int estimated_track, int& latest_track, ClearCounts& counts) {
  if (truth.ignored) {
    latest_track = FrameMatches::kNone;
    return;
  }
  if (estimated_track == FrameMatches::kNone) {
    ++counts.fn;
    return;
  }
  if (latest_track != FrameMatches::kNone && latest_track != estimated_track) ++counts.idsw;
  latest_track = estimated_track;
}

/// Counts fragmentations as TrackEval does: the times that a true object is matched after a frame
/// in which it was not (unmatched, ignored or not labelled), without the first.
///
/// Frames without truth, or without estimates, that are not ignored are passed over.
class FragmentCounter {
 public:
  explicit FragmentCounter(const ClassSequence& sequence)
      : matched_(static_cast<std::size_t>(sequence.true_tracks), false), ever_matched_(matched_) {}

  [[nodiscard]] std::size_t count(const ClassFrame& frame, const FrameMatches& matches) {
    if (!hasTruth(frame) || !hasEstimates(frame, matches)) return 0;
    std::size_t fragmentations = 0;
    std::vector<bool> matched(matched_.size(), false);
    for (std::size_t i = 0; i < frame.truth.size(); ++i) {
      if (frame.truth[i].ignored || matches.estimate_of[i] == FrameMatches::kNone) continue;
      const auto track = static_cast<std::size_t>(frame.truth[i].track);
      if (!matched_[track] && ever_matched_[track]) ++fragmentations;
      ever_matched_[track] = true;
      matched[track] = true;
    }
    matched_ = std::move(matched);
    return fragmentations;
  }

 private:
  static bool hasTruth(const ClassFrame& frame) {
    return std::any_of(frame.truth.begin(), frame.truth.end(),
                       [](const TrueBox& truth) { return !truth.ignored; });
  }

  static bool hasEstimates(const ClassFrame& frame, const FrameMatches& matches) {
    for (std::size_t j = 0; j < frame.estimates.size(); ++j) {
      const int i = matches.truth_of[j];
      if (i == FrameMatches::kExcluded) continue;
      const bool is_ignored = i == FrameMatches::kNone
                                  ? frame.estimates[j].ignored_if_unmatched
                                  : frame.truth[static_cast<std::size_t>(i)].ignored;
      if (!is_ignored) return true;
    }
    return false;
  }

  std::vector<bool> matched_;  ///< in the latest frame that was not passed over
  std::vector<bool> ever_matched_;
};

void countFrame(const ClassFrame& frame, const FrameMatches& matches, LatestTracks& latest_tracks,
                ClearCounts& counts) {
  for (std::size_t i = 0; i < frame.truth.size(); ++i) {
    const int j = matches.estimate_of[i];
    const bool matched = j != FrameMatches::kNone;
    const int track = matched ? frame.estimates[static_cast<std::size_t>(j)].track : j;
    countTruth(frame.truth[i], track, latest_tracks[static_cast<std::size_t>(frame.truth[i].track)],
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
    LatestTracks latest_tracks(static_cast<std::size_t>(sequence.true_tracks), FrameMatches::kNone);
    FragmentCounter fragments(sequence);
    for (const auto& frame : sequence.frames) {
      const auto matches = matcher.match(frame);
      countFrame(frame, matches, latest_tracks, counts);
      counts.frag += fragments.count(frame, matches);
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
