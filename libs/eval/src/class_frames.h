#pragma once

#include <headway/core/assignment.h>
#include <headway/eval/track_error.h>

namespace headway::eval {

struct TrueBox {
  int track = 0;         ///< number of its object within the sequence, from 0
  bool ignored = false;  ///< neither found nor missed
};

struct EstimatedBox {
  int track = 0;          ///< number of its track within the sequence, from 0
  double score = 0.0;     ///< mean over its track
  bool harmless = false;  ///< not wrong if nothing matches it
};

/// One frame as one class sees it. Rows of pairs are true boxes, columns estimated ones.
struct ClassFrame {
  std::vector<TrueBox> truth;
  std::vector<EstimatedBox> estimates;
  std::vector<CandidatePair> overlaps;   ///< pairs that overlap at all; cost: 1 - overlap
  std::vector<CandidatePair> positions;  ///< pairs whose position is right; cost: what is least
  std::vector<std::optional<double>> position_errors_m;  ///< of `positions`, on the ground
};

/// One sequence as one class sees it.
struct ClassSequence {
  std::vector<ClassFrame> frames;
  int true_tracks = 0;
  int estimated_tracks = 0;
};

/// Keeps what concerns a class of each frame, with the pairs that may belong together.
[[nodiscard]] ClassSequence classSequence(const LabelledSequence& sequence,
                                          ObjectClass object_class, const TrackErrorParams& params);

}  // namespace headway::eval
