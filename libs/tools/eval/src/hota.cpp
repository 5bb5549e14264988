// SPDX-License-Identifier: BSD-3-Clause
#include "hota.h"

#include <Eigen/Core>
#include <cmath>

namespace headway::eval {
namespace {

constexpr double kOverlapWeight = 1e-4;  // breaks ties between equal associations only

struct OverlappingPair {
  std::size_t row = 0;
  std::size_t column = 0;
  double overlap = 0.0;
};

/// A frame without ignored boxes.
struct CountedFrame {
  std::vector<int> truth;      ///< track of each row; -1 excluded
  std::vector<int> estimates;  ///< track of each column; -1 excluded
  std::vector<OverlappingPair> pairs;
};

CountedFrame withoutIgnored(const ClassFrame& frame, const FrameMatches& matches) {
  CountedFrame result;
  for (const auto& truth : frame.truth) result.truth.push_back(truth.ignored ? -1 : truth.track);
  for (std::size_t j = 0; j < frame.estimates.size(); ++j) {
    const int row = matches.truth_of[j];
    const bool matched = row >= 0;
    const bool ignored_if_unmatched =
        row == FrameMatches::kNone && frame.estimates[j].ignored_if_unmatched;
    const bool with_ignored = matched && frame.truth[static_cast<std::size_t>(row)].ignored;
    const bool excluded = row == FrameMatches::kExcluded || ignored_if_unmatched || with_ignored;
    result.estimates.push_back(excluded ? -1 : frame.estimates[j].track);
  }
  for (const auto& pair : frame.overlaps) {
    if (result.truth[pair.row] < 0 || result.estimates[pair.column] < 0) continue;
    result.pairs.push_back({pair.row, pair.column, 1.0 - pair.cost});
  }
  return result;
}

/// Frames in which each track appears.
Eigen::VectorXd appearances(const std::vector<CountedFrame>& frames,
                            std::vector<int> CountedFrame::*which, int tracks) {
  Eigen::VectorXd count = Eigen::VectorXd::Zero(tracks);
  for (const auto& frame : frames) {
    for (const int track : frame.*which) {
      if (track >= 0) count[track] += 1.0;
    }
  }
  return count;
}

/// Association scores between the true and estimated tracks of one sequence.
class Association {
 public:
  Association(const std::vector<CountedFrame>& frames, const ClassSequence& sequence)
      : frames_(frames),
        truth_frames_(appearances(frames, &CountedFrame::truth, sequence.true_tracks)),
        estimate_frames_(appearances(frames, &CountedFrame::estimates, sequence.estimated_tracks)) {
  }

  [[nodiscard]] HotaCounts::Level countsAt(double level) const {
    const Eigen::MatrixXd potential = agreement(togetherAt(level));
    Eigen::MatrixXd together = noPairs();
    HotaCounts::Level counts;
    for (const auto& frame : frames_) {
      std::vector<CandidatePair> candidates;
      for (const auto& pair : frame.pairs) {
        if (pair.overlap < level - 1e-9) continue;
        const auto [i, j] = tracksOf(frame, pair);
        candidates.push_back(
            {pair.row, pair.column, -potential(i, j) - kOverlapWeight * pair.overlap});
      }
      for (const auto& pair : assignPairs(std::move(candidates))) {
        const auto [i, j] = tracksOf(frame, pair);
        together(i, j) += 1.0;
        ++counts.tp;
      }
    }
    counts.fn = static_cast<std::size_t>(std::lround(truth_frames_.sum())) - counts.tp;
    counts.fp = static_cast<std::size_t>(std::lround(estimate_frames_.sum())) - counts.tp;
    counts.association_sum = together.cwiseProduct(agreement(together)).sum();
    return counts;
  }

 private:
  [[nodiscard]] Eigen::MatrixXd noPairs() const {
    return Eigen::MatrixXd::Zero(truth_frames_.size(), estimate_frames_.size());
  }

  template <typename Pair>
  static std::pair<int, int> tracksOf(const CountedFrame& frame, const Pair& pair) {
    return {frame.truth[pair.row], frame.estimates[pair.column]};
  }

  /// Frames in which each pair of tracks overlaps at least this much.
  [[nodiscard]] Eigen::MatrixXd togetherAt(double level) const {
    Eigen::MatrixXd together = noPairs();
    for (const auto& frame : frames_) {
      for (const auto& pair : frame.pairs) {
        const auto [i, j] = tracksOf(frame, pair);
        if (pair.overlap >= level - 1e-9) together(i, j) += 1.0;
      }
    }
    return together;
  }

  /// Frames together over frames of either, for each pair of tracks (0..1).
  [[nodiscard]] Eigen::MatrixXd agreement(const Eigen::MatrixXd& together) const {
    Eigen::MatrixXd result = noPairs();
    for (Eigen::Index i = 0; i < result.rows(); ++i) {
      for (Eigen::Index j = 0; j < result.cols(); ++j) {
        if (!(together(i, j) > 0.0)) continue;
        result(i, j) = together(i, j) / (truth_frames_[i] + estimate_frames_[j] - together(i, j));
      }
    }
    return result;
  }

  const std::vector<CountedFrame>& frames_;
  Eigen::VectorXd truth_frames_;
  Eigen::VectorXd estimate_frames_;
};

}  // namespace

void HotaCounts::add(const HotaCounts& other) {
  for (std::size_t k = 0; k < kLevels; ++k) {
    levels[k].tp += other.levels[k].tp;
    levels[k].fp += other.levels[k].fp;
    levels[k].fn += other.levels[k].fn;
    levels[k].association_sum += other.levels[k].association_sum;
  }
}

HotaCounts hotaCounts(const ClassSequence& sequence, double min_overlap, double score_threshold) {
  FrameMatcher matcher(sequence, min_overlap, score_threshold);
  std::vector<CountedFrame> frames;
  for (const auto& frame : sequence.frames) {
    frames.push_back(withoutIgnored(frame, matcher.match(frame)));
  }
  const Association association(frames, sequence);
  HotaCounts counts;
  for (std::size_t k = 0; k < HotaCounts::kLevels; ++k) {
    counts.levels[k] = association.countsAt(0.05 * static_cast<double>(k + 1));
  }
  return counts;
}

Hota hotaOf(const HotaCounts& counts) {
  Hota result;
  for (const auto& level : counts.levels) {
    if (level.tp == 0) continue;
    const double det =
        static_cast<double>(level.tp) / static_cast<double>(level.tp + level.fp + level.fn);
    const double ass = level.association_sum / static_cast<double>(level.tp);
    result.deta += det / HotaCounts::kLevels;
    result.assa += ass / HotaCounts::kLevels;
    result.hota += std::sqrt(det * ass) / HotaCounts::kLevels;
  }
  return result;
}

}  // namespace headway::eval
