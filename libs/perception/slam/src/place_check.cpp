// SPDX-License-Identifier: BSD-3-Clause
// Whether a frame shows the place that it was recognised as.
#include "place_check.h"

#include <headway/stereo/disparity.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>

namespace headway::slam {

namespace {

constexpr double kMaxGap_s = 2.0;  ///< between two frames that show a place

/// Landmarks of a place that the map has elsewhere, too: several of them are alike others that lie
/// by one shift away.
std::set<LandmarkId> repeated(const std::vector<LandmarkId>& place, const SparseMap& map,
                              double within_m) {
  constexpr double kHalfBin_m = 0.2;  // of shifts that are one; bins overlap by half
  constexpr std::size_t kAlike = 6;   // that chance does not bring
  std::vector<const Landmark*> here;
  for (const LandmarkId id : place) {
    const Landmark* landmark = map.find(id);
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

/// Those of the landmarks that are seen by the keyframe which sees most of a place.
std::vector<LandmarkId> seenByNearest(const std::vector<TrackedLandmark>& place,
                                      const std::vector<LandmarkId>& landmarks,
                                      const SparseMap& map) {
  std::map<KeyframeId, int> shared;
  for (const TrackedLandmark& seen : place) {
    const Landmark* landmark = map.find(seen.id);
    if (landmark == nullptr) continue;
    for (const LandmarkObservation& by : landmark->observations) ++shared[by.keyframe];
  }
  const auto nearest =
      std::max_element(shared.begin(), shared.end(),
                       [](const auto& a, const auto& b) { return a.second < b.second; });
  std::vector<LandmarkId> expected;
  for (const LandmarkId id : landmarks) {
    const Landmark* landmark = map.find(id);
    if (landmark == nullptr) continue;
    const auto isBy = [&](const LandmarkObservation& by) {
      return nearest == shared.end() || by.keyframe == nearest->first;
    };
    const auto& observations = landmark->observations;
    if (std::any_of(observations.begin(), observations.end(), isBy)) expected.push_back(id);
  }
  return expected;
}

/// A part of the image with the landmarks that ought to be seen in it.
struct Cell {
  std::set<LandmarkId> found;
  std::vector<LandmarkId> missed;
  bool is_hidden = false;  ///< in part, by something nearer
};
using Cells = std::map<std::pair<int, int>, Cell>;

Cells cellsOf(const TrackedPose& seen, const std::vector<LandmarkId>& among,
              const TrackingFrame& frame, const SparseMap& map, const StereoCamera& camera,
              const SlamParams& params) {
  const LandmarkTracker tracker(camera, params);
  const auto matcher = matcherFor(camera, params);
  const Pose T_cam_map = seen.T_map_cam.inverse(Eigen::Isometry);
  Cells cells;
  const auto cellAt = [&](const Eigen::Vector2d& uv) -> Cell& {
    const Eigen::Vector2i at = (uv * 16.0 / camera.width).cast<int>();
    return cells[{at.x(), at.y()}];
  };
  for (const TrackedLandmark& landmark : seen.landmarks) {
    cellAt(landmark.measurement.uv).found.insert(landmark.id);
  }
  for (const LandmarkId id : seenByNearest(seen.landmarks, among, map)) {
    const Landmark& landmark = *map.find(id);
    const auto uvd = visibleAt(T_cam_map * landmark.position, frame, camera);
    if (!uvd) continue;
    Cell& cell = cellAt(uvd->head<2>());
    if (cell.found.count(id) > 0) continue;
    const auto is_found = tracker.isFoundAt(*uvd, landmark, frame, seen.T_map_cam, map);
    if (!is_found) continue;
    if (*is_found) {
      cell.found.insert(id);
    } else if (const auto disparity = matcher.search(frame.left, frame.right, uvd->head<2>())) {
      const bool is_hidden = *disparity > stereo::nearerThan(uvd->z());
      if (is_hidden) cell.is_hidden = true;
      if (!is_hidden) cell.missed.push_back(id);
    }
  }
  return cells;
}

}  // namespace

bool standsOnGround(const Pose& T_map_cam, const Eigen::Vector3d& up, const SparseMap& map) {
  const auto distance = [&](const auto& keyframe) {
    return (keyframe.second.T_map_cam.translation() - T_map_cam.translation()).norm();
  };
  const auto& keyframes = map.keyframes();
  const auto nearest =
      std::min_element(keyframes.begin(), keyframes.end(),
                       [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  const Pose T_key_cam = nearest->second.T_map_cam.inverse(Eigen::Isometry) * T_map_cam;
  const double tilt = std::acos(std::clamp(up.dot(T_key_cam.linear() * up), -1.0, 1.0));
  // A kerb, and ground that seems level.
  const double most = 0.1 + (0.05 + tilt) * T_key_cam.translation().norm();
  return std::abs(up.dot(T_key_cam.translation())) <= most;
}

PlaceEvidence evidenceOf(const TrackedPose& seen, const std::vector<LandmarkId>& among,
                         const TrackingFrame& frame, const SparseMap& map,
                         const StereoCamera& camera, const SlamParams& params, double within_m) {
  Cells cells = cellsOf(seen, among, frame, map, camera, params);
  std::vector<LandmarkId> found;
  for (const auto& [at, cell] : cells)
    found.insert(found.end(), cell.found.begin(), cell.found.end());
  const auto ambiguous = repeated(found, map, within_m);
  PlaceEvidence evidence;
  for (auto& [at, cell] : cells) {
    if (cell.found.size() > cell.missed.size()) {
      std::vector<LandmarkId> unique;
      std::set_difference(cell.found.begin(), cell.found.end(), ambiguous.begin(), ambiguous.end(),
                          std::back_inserter(unique));
      if (!unique.empty()) evidence.found.push_back(std::move(unique));
    } else if (cell.found.size() < cell.missed.size() && !cell.is_hidden) {
      evidence.missed.push_back(std::move(cell.missed));
    }
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
                       [](const Seen& a, const Seen& b) { return a.evidence() < b.evidence(); });
  if (likeliest == seen_.end()) return std::nullopt;
  return Place{likeliest->T_map_odom * T_odom_cam, likeliest->keyframe};
}

bool isAllowed(const Pose& T_map_cam, const Pose& T_map_led, double seconds) {
  const Pose T_led_cam = T_map_led.inverse(Eigen::Isometry) * T_map_cam;
  return T_led_cam.translation().norm() <= 0.1 + 1.5 * seconds &&
         Eigen::AngleAxisd(T_led_cam.linear()).angle() <= 0.05 + 2.0 * seconds;
}

std::size_t PlaceCheck::addTo(Time time, const LocatedCamera& located, const Pose& T_odom_cam) {
  const Pose& T_map_cam = located.tracked.T_map_cam;
  // Whether it is where odometry has led since the place was seen last.
  const auto agrees = [&](const Seen& seen) {
    return isAllowed(T_map_cam, seen.T_map_odom * T_odom_cam, std::abs(time - seen.time));
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
  const auto countNew = [&place](const std::vector<std::vector<LandmarkId>>& cells, int& count) {
    for (const auto& cell : cells) {
      const auto isKnown = [&](LandmarkId id) { return place->counted.count(id) > 0; };
      if (std::none_of(cell.begin(), cell.end(), isKnown)) ++count;
      place->counted.insert(cell.begin(), cell.end());
    }
  };
  countNew(located.evidence.found, place->found);
  countNew(located.evidence.missed, place->missed);
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
      if (&other != &place) rival = std::max(rival, other.likeness());
    }
    // A place that another one is like half as much is a copy of it, seen from another side.
    const int needed = rival + std::max(kPlaceProof, rival);
    if (places[i].evidence.proof() >= needed ||
        (place.evidence() >= needed && time - place.since >= 0.199)) {
      return &places[i];
    }
  }
  return nullptr;
}

}  // namespace headway::slam
