// SPDX-License-Identifier: BSD-3-Clause
// What a lost camera does: it looks for its place in the whole map.
#include "relocaliser.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace headway::slam {

void Relocaliser::expect(const Pose& T_map_cam) {
  expected_ = T_map_cam;
  T_odom_expected_.reset();
}

void Relocaliser::moveExpected(const Pose& T_odom_cam) {
  if (!expected_) return loops_.expect(std::nullopt);
  if (!T_odom_expected_) T_odom_expected_ = T_odom_cam;
  loops_.expect(*expected_ * T_odom_expected_->inverse(Eigen::Isometry) * T_odom_cam);
}

std::optional<LocatedCamera> Relocaliser::locate(const TrackingFrame& frame, int turn,
                                                 const Pose& T_odom_cam,
                                                 const std::function<bool(const Pose&)>& isLed,
                                                 const Allows& isAllowed, const SparseMap& map) {
  const auto locate = [&](std::optional<int> only) {
    auto places = loops_.locate(frame, only, map);
    const auto last = std::stable_partition(places.begin(), places.end(), isAllowed);
    places.erase(last, places.end());
    return places;
  };
  auto places = locate(turn);
  if (const auto before = check_.likeliest(frame.time, T_odom_cam)) {
    auto again = loops_.locateAt(*before, frame, map);
    if (again) places.push_back(std::move(*again));
  }
  if (places.empty()) return std::nullopt;
  if (isLed(places.front().tracked.T_map_cam)) return std::move(places.front());
  const LocatedCamera* located = check_.add(frame.time, places, T_odom_cam);
  if (located == nullptr) return std::nullopt;
  // Another place that looks alike may not have had its turn.
  const LocatedCamera first = *located;
  places = locate(std::nullopt);
  places.insert(places.begin(), first);
  located = check_.add(frame.time, places, T_odom_cam);
  return located != nullptr ? std::optional(*located) : std::nullopt;
}

void Relocaliser::end(bool is_in_map) {
  check_.restart();
  if (is_in_map) expected_.reset();
}

}  // namespace headway::slam
