// SPDX-License-Identifier: BSD-3-Clause
// Whether a frame shows the place that it was recognised as.
#include "place_check.h"

#include <map>
#include <set>
#include <utility>

namespace headway::slam {

int evidenceOf(const TrackedPose& seen, const std::vector<LandmarkId>& expected,
               const TrackingFrame& frame, const SparseMap& map, const StereoCamera& camera,
               const stereo::StereoMatcher& matcher) {
  constexpr double kNearer = 1.2;  ///< ratio of disparities, from which something stands before
  const double cell_px = camera.width / 16.0;
  const auto cellOf = [&](const Eigen::Vector2d& uv) {
    const Eigen::Vector2i at = (uv / cell_px).cast<int>();
    return std::pair(at.x(), at.y());
  };
  std::set<std::pair<int, int>> found, missed, hidden;
  for (const TrackedLandmark& landmark : seen.landmarks) {
    found.insert(cellOf(landmark.measurement.uv));
  }
  const Pose T_cam_map = seen.T_map_cam.inverse(Eigen::Isometry);
  for (const LandmarkId id : expected) {
    const Landmark* landmark = map.find(id);
    if (landmark == nullptr) continue;
    const auto uvd = visibleAt(T_cam_map * landmark->position, frame, camera);
    if (!uvd || found.count(cellOf(uvd->head<2>())) > 0) continue;
    const auto disparity = matcher.search(frame.left, frame.right, uvd->head<2>());
    if (!disparity) continue;
    const bool is_hidden = *disparity > kNearer * uvd->z() + 1.0;
    (is_hidden ? hidden : missed).insert(cellOf(uvd->head<2>()));
  }
  int evidence = static_cast<int>(found.size());
  for (const auto& cell : missed) evidence -= hidden.count(cell) > 0 ? 0 : 1;
  return evidence;
}

bool PlaceCheck::agrees(Time time, const Pose& T_map_cam, const Pose& T_odom_cam) const {
  if (!before_) return false;
  const double seconds = time - before_->time;
  if (seconds > 2.0) return false;
  const Pose T_expected_cam =
      (before_->T_map_odom * T_odom_cam).inverse(Eigen::Isometry) * T_map_cam;
  return T_expected_cam.translation().norm() <= 0.1 + 1.5 * seconds &&
         Eigen::AngleAxisd(T_expected_cam.linear()).angle() <= 0.05 + 2.0 * seconds;
}

bool PlaceCheck::add(Time time, int evidence, const Pose& T_map_cam, const Pose& T_odom_cam) {
  if (evidence < kPlaceProof / 2) return false;
  Observation now{time, time, evidence, T_map_cam * T_odom_cam.inverse(Eigen::Isometry)};
  if (agrees(time, T_map_cam, T_odom_cam)) {
    now.since = before_->since;
    now.evidence += before_->evidence;
  }
  before_ = now;
  return evidence >= kPlaceProof || (now.evidence >= kPlaceProof && now.time - now.since >= 0.199);
}

}  // namespace headway::slam
