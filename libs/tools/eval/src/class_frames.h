// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/assignment.h>
#include <headway/eval/track_error.h>

namespace headway::eval {

struct TrueBox {
  int track = 0;         ///< index of its object within the sequence
  bool ignored = false;  ///< excluded from true positives and misses
};

struct EstimatedBox {
  int track = 0;                      ///< index of its track within the sequence
  double score = 0.0;                 ///< mean score of its track
  bool ignored_if_unmatched = false;  ///< not a false positive if unmatched
};

/// Boxes of one class in one frame. Rows of pairs are true boxes, columns estimated boxes.
struct ClassFrame {
  std::vector<TrueBox> truth;
  std::vector<EstimatedBox> estimates;
  std::vector<CandidatePair> overlaps;  ///< overlapping pairs; cost: 1 - overlap
  std::vector<CandidatePair>
      positions;  ///< pairs with correct positions; cost: distance or 1 - overlap
  std::vector<std::optional<double>> position_errors_m;  ///< of `positions`, on the ground
};

/// Boxes of one class in one sequence.
struct ClassSequence {
  std::vector<ClassFrame> frames;
  int true_tracks = 0;
  int estimated_tracks = 0;
};

/// Selects the boxes of one class and its neighbouring class, with the candidate pairs.
[[nodiscard]] ClassSequence classSequence(const LabelledSequence& sequence,
                                          ObjectClass object_class, const TrackErrorParams& params);

/// Matches of one frame.
struct FrameMatches {
  static constexpr int kNone = -1;
  static constexpr int kExcluded = -2;  ///< score below the threshold
  std::vector<int> estimate_of;         ///< per true box: column or kNone
  std::vector<int> truth_of;            ///< per estimate: row, kNone or kExcluded
};

/// Matches estimates with truth frame by frame (CLEAR MOT).
///
/// Matches of the previous frame are kept while they overlap enough; the rest is assigned with the
/// maximum number of matches and, among these, the maximum overlap.
///
/// @see Bernardin & Stiefelhagen 2008, Sec. 2.1.2
class FrameMatcher {
 public:
  FrameMatcher(const ClassSequence& sequence, double min_overlap, double score_threshold)
      : min_overlap_(min_overlap),
        score_threshold_(score_threshold),
        previous_(static_cast<std::size_t>(sequence.true_tracks), FrameMatches::kNone) {}

  [[nodiscard]] FrameMatches match(const ClassFrame& frame);

 private:
  double min_overlap_;
  double score_threshold_;
  std::vector<int> previous_;  ///< estimated track of each true one in the previous frame, or kNone
};

}  // namespace headway::eval
