#pragma once

#include <headway/eval/trajectory_error.h>

namespace headway::eval {

/// Motion of the estimate seen from the true motion, from pair `from` to pair `to`: the identity
/// if both moved alike.
///
/// @see Sturm et al. 2012, eq. 1
[[nodiscard]] Pose relativeError(const PosePair& from, const PosePair& to);

/// Length of the true path from the first pair to each pair [m].
[[nodiscard]] std::vector<double> trueDistances(const std::vector<PosePair>& pairs);

/// Relative errors over segments of the true path.
///
/// A segment of length L starts at every `segment_step`-th pair and ends at the first pair more
/// than L further on; its errors are those of the relative pose, divided by L.
///
/// @return nullopt if no segment fits
/// @see    Geiger et al. 2012, eqs. 2-3
[[nodiscard]] std::optional<SegmentErrors> segmentErrors(const std::vector<PosePair>& pairs,
                                                         const TrajectoryErrorParams& params);

}  // namespace headway::eval
