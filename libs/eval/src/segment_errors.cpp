#include "segment_errors.h"

#include <algorithm>
#include <cmath>

namespace headway::eval {

Pose relativeError(const PosePair& from, const PosePair& to) {
  const Pose true_motion = from.truth.inverse() * to.truth;
  const Pose estimated_motion = from.estimate.inverse() * to.estimate;
  return true_motion.inverse() * estimated_motion;
}

std::vector<double> trueDistances(const std::vector<PosePair>& pairs) {
  std::vector<double> distances;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const double step =
        i == 0 ? 0.0 : (pairs[i].truth.translation() - pairs[i - 1].truth.translation()).norm();
    distances.push_back(i == 0 ? 0.0 : distances.back() + step);
  }
  return distances;
}

std::optional<SegmentErrors> segmentErrors(const std::vector<PosePair>& pairs,
                                           const TrajectoryErrorParams& params) {
  const auto distances = trueDistances(pairs);
  double trans_sum = 0.0;
  double rot_sum = 0.0;
  std::size_t segments = 0;
  for (std::size_t first = 0; first < pairs.size(); first += params.segment_step) {
    for (const double length : params.segment_lengths_m) {
      const auto last =
          std::upper_bound(distances.begin(), distances.end(), distances[first] + length);
      if (last == distances.end()) continue;
      const Pose error =
          relativeError(pairs[first], pairs[static_cast<std::size_t>(last - distances.begin())]);
      trans_sum += error.translation().norm() / length;
      rot_sum += logSo3(error.linear()).norm() / length;
      ++segments;
    }
  }
  if (segments == 0) return std::nullopt;
  const auto count = static_cast<double>(segments);
  return SegmentErrors{100.0 * trans_sum / count, rot_sum / count * 180.0 / M_PI, segments};
}

}  // namespace headway::eval
