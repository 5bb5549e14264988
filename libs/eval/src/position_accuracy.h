#pragma once

#include "class_frames.h"

namespace headway::eval {

/// Right and wrong positions, whatever the score.
struct PositionCounts {
  std::size_t tp = 0, fp = 0, fn = 0;
  std::size_t measured = 0;     ///< true positives whose distance is known
  double squared_sum_m2 = 0.0;  ///< of their distances on the ground

  void add(const PositionCounts& other);
};

/// Pairs estimates with truth by position, each frame on its own.
[[nodiscard]] PositionCounts positionCounts(const ClassSequence& sequence);

}  // namespace headway::eval
