// SPDX-License-Identifier: BSD-3-Clause
#include "score_quality.h"

#include <algorithm>
#include <cmath>

namespace headway::objects {

// Welford's update.
void ScoreQuality::learn(const MeasuredBox& box) {
  Scores& scores = scores_[static_cast<std::size_t>(box.object_class)];
  const double before = box.score - scores.mean;
  ++scores.count;
  scores.mean += before / static_cast<double>(scores.count);
  scores.squares += before * (box.score - scores.mean);
}

MeasuredBox ScoreQuality::scaled(MeasuredBox box) const {
  constexpr double kNoiseOfOneSigma = 1.4;  ///< ratio of the noise one standard deviation lower
  constexpr double kMaxSigmas = 2.0;
  const Scores& scores = scores_[static_cast<std::size_t>(box.object_class)];
  const double sigma =
      std::sqrt(scores.squares / static_cast<double>(std::max<std::size_t>(scores.count, 1)));
  if (!(sigma > 0.0)) return box;
  const double above = std::clamp((box.score - scores.mean) / sigma, -kMaxSigmas, kMaxSigmas);
  box.size_sigma_m *= std::pow(kNoiseOfOneSigma, -above);
  return box;
}

}  // namespace headway::objects
