// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "class_frames.h"

namespace headway::eval {

/// Counts of HOTA at the overlaps 0.05, 0.10 .. 0.95.
struct HotaCounts {
  static constexpr std::size_t kLevels = 19;
  struct Level {
    std::size_t tp = 0, fp = 0, fn = 0;
    double association_sum = 0.0;  ///< association score of the true positives, 0..1 each
  };
  std::array<Level, kLevels> levels;

  void add(const HotaCounts& other);
};

/// Means over all levels.
struct Hota {
  double hota = 0.0;
  double deta = 0.0;
  double assa = 0.0;
};

/// Counts over one sequence with the tracks that reach the score threshold.
///
/// Ignored truth, estimates that CLEAR MOT matches with it, and unmatched estimates that are not
/// false positives are excluded.
///
/// @see Luiten et al. 2021, Sec. 5 and Sec. 6 (matching: maximum number, then association, then
///      overlap)
[[nodiscard]] HotaCounts hotaCounts(const ClassSequence& sequence, double min_overlap,
                                    double score_threshold);

/// @see Luiten et al. 2021, eqs. 14-16 and 27
[[nodiscard]] Hota hotaOf(const HotaCounts& counts);

}  // namespace headway::eval
