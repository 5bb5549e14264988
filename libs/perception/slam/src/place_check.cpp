// SPDX-License-Identifier: BSD-3-Clause
// Whether a frame shows the place that it was recognised as.
#include "place_check.h"

#include <array>
#include <map>
#include <set>
#include <utility>

namespace headway::slam {

namespace {

/// Landmarks of a place that the map has elsewhere, too: several of them are alike others that lie
/// by one shift away.
std::set<LandmarkId> repeated(const std::vector<TrackedLandmark>& place, const SparseMap& map,
                              double within_m) {
  constexpr double kHalfBin_m = 0.2;  // of shifts that are one; bins overlap by half
  constexpr std::size_t kAlike = 6;   // that chance does not bring
  std::vector<const Landmark*> here;
  for (const TrackedLandmark& seen : place) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark != nullptr && landmark->descriptor != Descriptor{}) here.push_back(landmark);
  }
  std::map<std::array<int, 3>, std::set<LandmarkId>> alike_by_shift;
  for (const auto& [id, there] : map.landmarks()) {
    for (const Landmark* landmark : here) {
      const Eigen::Vector3d shift = there.position - landmark->position;
      const double away_m = shift.norm();
      if (away_m < 1.0 || away_m > within_m ||
          distance(landmark->descriptor, there.descriptor) > kMaxDescriptorDistance) {
        continue;
      }
      const Eigen::Array3i bin = (shift / kHalfBin_m).array().floor().cast<int>();
      for (int i = 0; i < 8; ++i) {
        alike_by_shift[{bin.x() + i % 2, bin.y() + i / 2 % 2, bin.z() + i / 4}].insert(
            landmark->id);
      }
    }
  }
  std::set<LandmarkId> all;
  for (const auto& [shift, alike] : alike_by_shift) {
    if (alike.size() >= kAlike) all.insert(alike.begin(), alike.end());
  }
  return all;
}

}  // namespace

int evidenceOf(const TrackedPose& seen, const std::vector<LandmarkId>& expected,
               const TrackingFrame& frame, const SparseMap& map, const StereoCamera& camera,
               const stereo::StereoMatcher& matcher, double within_m) {
  constexpr double kNearer = 1.2;  ///< ratio of disparities, from which something stands before
  const double cell_px = camera.width / 16.0;
  const auto cellOf = [&](const Eigen::Vector2d& uv) {
    const Eigen::Vector2i at = (uv / cell_px).cast<int>();
    return std::pair(at.x(), at.y());
  };
  std::set<std::pair<int, int>> found, unique, missed, hidden;
  const auto ambiguous = repeated(seen.landmarks, map, within_m);
  for (const TrackedLandmark& landmark : seen.landmarks) {
    const auto cell = cellOf(landmark.measurement.uv);
    found.insert(cell);
    if (ambiguous.count(landmark.id) == 0) unique.insert(cell);
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
  int evidence = static_cast<int>(unique.size());
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
