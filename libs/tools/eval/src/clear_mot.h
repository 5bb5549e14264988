// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "class_frames.h"

namespace headway::eval {

/// Counts of CLEAR MOT.
struct ClearCounts {
  std::size_t tp = 0, fp = 0, fn = 0, idsw = 0, frag = 0;
  double overlap_sum = 0.0;         ///< of the true positives
  std::vector<double> true_scores;  ///< track scores of the true positives

  [[nodiscard]] std::size_t truth() const { return tp + fn; }
  [[nodiscard]] std::size_t errors() const { return fp + fn + idsw; }
  [[nodiscard]] double mota() const;  ///< requires truth() > 0
  void add(const ClearCounts& other);
};

/// Counts over sequences with the tracks that reach the score threshold.
[[nodiscard]] ClearCounts clearCounts(const std::vector<ClassSequence>& sequences,
                                      double min_overlap, double score_threshold);

/// CLEAR MOT over the score thresholds of a class.
struct ClearCurve {
  ClearCounts best;  ///< at the threshold of maximum MOTA
  double best_threshold = 0.0;
  std::vector<RecallPoint> points;
  double samota = 0.0;
  double amota = 0.0;
};

/// Evaluates without a threshold and at the thresholds that reach the recalls 1/40, 2/40 .. 1.
///
/// @return nullopt if there is no truth
/// @see    Weng et al. 2020, Sec. IV, eqs. 5-8
[[nodiscard]] std::optional<ClearCurve> clearCurve(const std::vector<ClassSequence>& sequences,
                                                   double min_overlap);

}  // namespace headway::eval
