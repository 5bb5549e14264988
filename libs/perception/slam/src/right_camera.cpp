// SPDX-License-Identifier: BSD-3-Clause
#include "right_camera.h"

#include <headway/stereo/right_turn.h>

#include <algorithm>
#include <iterator>
#include <vector>

namespace headway::slam {
namespace {

/// Moves a landmark along the ray of its reference keyframe to its disparity there.
void placeByReference(const StereoCamera& camera, const SparseMap& map, Landmark& landmark) {
  const auto seen = std::find_if(
      landmark.observations.begin(), landmark.observations.end(),
      [&](const LandmarkObservation& one) { return one.keyframe == landmark.reference; });
  if (seen == landmark.observations.end() || !seen->measurement.stereo) return;
  const stereo::StereoMeasurement measured = map.corrected(seen->measurement);
  const auto point_cam =
      triangulate({measured.uv.x(), measured.uv.y(), measured.disparity}, camera);
  if (point_cam) landmark.position = map.keyframe(landmark.reference).T_map_cam * *point_cam;
}

}  // namespace

void turnRightCamera(const Eigen::Vector3d& angles, const StereoCamera& camera, SparseMap& map) {
  const Eigen::Vector3d before = map.rightTurn();
  if (angles.y() != before.y()) map.setDisparityOffset(0.0);
  std::vector<LandmarkId> ids;
  for (const auto& [id, landmark] : map.landmarks()) ids.push_back(id);
  for (const LandmarkId id : ids) {
    Landmark& landmark = *map.findToChange(id);
    for (auto& [keyframe, measurement] : landmark.observations) {
      if (!measurement.stereo) continue;
      measurement.disparity =
          stereo::turnedDisparity(measurement.uv, measurement.disparity, before, angles, camera);
    }
    placeByReference(camera, map, landmark);
  }
  map.setRightTurn(angles);
}

std::map<KeyframeId, double> scaleChanges(const std::map<KeyframeId, Pose>& before,
                                          const SparseMap& map) {
  constexpr double kLeastWay = 0.01;  // [m]; shorter ones tell no scale
  constexpr double kMostChange = 2.0;
  std::map<KeyframeId, double> ratios;
  const auto way = [](const Pose& a, const Pose& b) {
    return (a.translation() - b.translation()).norm();
  };
  for (auto at = before.begin(); at != before.end() && before.size() > 1; ++at) {
    auto from = at;
    if (std::next(at) == before.end()) --from;
    const auto to = std::next(from);
    const double old_way = way(from->second, to->second);
    if (old_way < kLeastWay) continue;
    const double new_way =
        way(map.keyframe(from->first).T_map_cam, map.keyframe(to->first).T_map_cam);
    ratios[at->first] = std::clamp(new_way / old_way, 1.0 / kMostChange, kMostChange);
  }
  return ratios;
}

}  // namespace headway::slam
