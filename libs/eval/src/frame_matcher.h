#pragma once

#include "class_frames.h"

namespace headway::eval {

/// Who belongs to whom in one frame.
struct FrameMatches {
  static constexpr int kNone = -1;
  static constexpr int kLeftOut = -2;  ///< its score is below the threshold
  std::vector<int> estimate_of;        ///< of each true box: column or kNone
  std::vector<int> truth_of;           ///< of each estimate: row, kNone or kLeftOut
};

/// Matches estimates with truth frame after frame (CLEAR MOT).
///
/// What was matched in the frame before stays matched where it still overlaps enough; the rest is
/// assigned so that most are matched and the overlaps are greatest.
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
  std::vector<int> previous_;  ///< estimated track of each true one in the last frame, or kNone
};

}  // namespace headway::eval
