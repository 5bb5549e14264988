// SPDX-License-Identifier: BSD-3-Clause
#include "shared_view.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <map>

namespace headway::slam {

SharedView sharedView(KeyframeId keyframe, const std::vector<TrackedLandmark>& tracked,
                      const SparseMap& map) {
  std::vector<double> flow;
  for (const TrackedLandmark& seen : tracked) {
    for (const LandmarkObservation& observation : map.find(seen.id)->observations) {
      if (observation.keyframe != keyframe) continue;
      flow.push_back((observation.measurement.uv - seen.measurement.uv).norm());
    }
  }
  return {keyframe, static_cast<int>(flow.size()), percentile(flow, 0.5)};
}

std::optional<SharedView> nearestView(const std::vector<TrackedLandmark>& tracked,
                                      const SparseMap& map,
                                      const std::function<bool(KeyframeId)>& wanted) {
  std::map<KeyframeId, int> shared;
  int max = 0;
  for (const TrackedLandmark& seen : tracked) {
    for (const LandmarkObservation& observation : map.find(seen.id)->observations) {
      max = std::max(max, ++shared[observation.keyframe]);
    }
  }
  std::optional<SharedView> nearest;
  for (const auto& [id, landmarks] : shared) {
    if (2 * landmarks < max || !wanted(id)) continue;
    const SharedView view = sharedView(id, tracked, map);
    if (!nearest || view.flow_px < nearest->flow_px) nearest = view;
  }
  return nearest;
}

}  // namespace headway::slam
