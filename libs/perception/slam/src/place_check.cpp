// SPDX-License-Identifier: BSD-3-Clause
// Whether a frame shows the place that it was recognised as.
#include "place_check.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <utility>

namespace headway::slam {

namespace {

constexpr double kMaxGap_s = 2.0;  ///< between two frames that show a place

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

PlaceEvidence evidenceOf(const TrackedPose& seen, const std::vector<LandmarkId>& expected,
                         const TrackingFrame& frame, const SparseMap& map,
                         const StereoCamera& camera, const stereo::StereoMatcher& matcher,
                         double within_m) {
  constexpr double kNearer = 1.2;  ///< ratio of disparities, from which something stands before
  const double cell_px = camera.width / 16.0;
  const auto cellOf = [&](const Eigen::Vector2d& uv) {
    const Eigen::Vector2i at = (uv / cell_px).cast<int>();
    return std::pair(at.x(), at.y());
  };
  std::map<std::pair<int, int>, std::vector<LandmarkId>> unique, missed;
  std::set<std::pair<int, int>> found, hidden;
  const auto ambiguous = repeated(seen.landmarks, map, within_m);
  for (const TrackedLandmark& landmark : seen.landmarks) {
    const auto cell = cellOf(landmark.measurement.uv);
    found.insert(cell);
    if (ambiguous.count(landmark.id) == 0) unique[cell].push_back(landmark.id);
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
    if (is_hidden) {
      hidden.insert(cellOf(uvd->head<2>()));
    } else {
      missed[cellOf(uvd->head<2>())].push_back(id);
    }
  }
  PlaceEvidence evidence;
  for (auto& [cell, landmarks] : unique) evidence.found.push_back(std::move(landmarks));
  for (auto& [cell, landmarks] : missed) {
    if (hidden.count(cell) == 0) evidence.missed.push_back(std::move(landmarks));
  }
  return evidence;
}

void PlaceCheck::removeOld(Time time) {
  // A clock that is set back leaves places of a time to come.
  const auto isOld = [time](const Seen& seen) { return std::abs(time - seen.time) > kMaxGap_s; };
  seen_.erase(std::remove_if(seen_.begin(), seen_.end(), isOld), seen_.end());
}

std::optional<PlaceCheck::Place> PlaceCheck::likeliest(Time time, const Pose& T_odom_cam) {
  removeOld(time);
  const auto likeliest =
      std::max_element(seen_.begin(), seen_.end(),
                       [](const Seen& a, const Seen& b) { return a.evidence < b.evidence; });
  if (likeliest == seen_.end()) return std::nullopt;
  return Place{likeliest->T_map_odom * T_odom_cam, likeliest->keyframe};
}

std::size_t PlaceCheck::addTo(Time time, const LocatedCamera& located, const Pose& T_odom_cam) {
  const Pose& T_map_cam = located.tracked.T_map_cam;
  // Whether it is where odometry has led since the place was seen last.
  const auto agrees = [&](const Seen& seen) {
    const double seconds = std::abs(time - seen.time);
    const Pose T_expected_cam = (seen.T_map_odom * T_odom_cam).inverse(Eigen::Isometry) * T_map_cam;
    return T_expected_cam.translation().norm() <= 0.1 + 1.5 * seconds &&
           Eigen::AngleAxisd(T_expected_cam.linear()).angle() <= 0.05 + 2.0 * seconds;
  };
  auto place = std::find_if(seen_.begin(), seen_.end(), agrees);
  if (place == seen_.end()) {
    seen_.emplace_back();
    place = std::prev(seen_.end());
    place->since = time;
  }
  place->time = time;
  place->T_map_odom = T_map_cam * T_odom_cam.inverse(Eigen::Isometry);
  place->keyframe = located.keyframe;
  const auto countNew = [&place](const std::vector<std::vector<LandmarkId>>& cells, int each) {
    for (const auto& cell : cells) {
      const auto isKnown = [&](LandmarkId id) { return place->counted.count(id) > 0; };
      if (std::none_of(cell.begin(), cell.end(), isKnown)) place->evidence += each;
      place->counted.insert(cell.begin(), cell.end());
    }
  };
  // Of places that are alike, four in ten cells that are found are missed, of the right one fewer
  // than two, whatever stands before it.
  countNew(located.evidence.found, 1);
  countNew(located.evidence.missed, -2);
  return static_cast<std::size_t>(place - seen_.begin());
}

const LocatedCamera* PlaceCheck::add(Time time, const std::vector<LocatedCamera>& places,
                                     const Pose& T_odom_cam) {
  removeOld(time);
  std::vector<std::size_t> seen_as;
  for (const LocatedCamera& located : places) seen_as.push_back(addTo(time, located, T_odom_cam));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Seen& place = seen_[seen_as[i]];
    int rival = 0;
    for (const Seen& other : seen_) {
      if (&other != &place) rival = std::max(rival, other.evidence);
    }
    // A place that another one is like half as much is a copy of it, seen from another side.
    const int needed = rival + std::max(kPlaceProof, rival);
    if (places[i].evidence.sum() >= needed ||
        (place.evidence >= needed && time - place.since >= 0.199)) {
      return &places[i];
    }
  }
  return nullptr;
}

}  // namespace headway::slam
