// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "street_stretch.h"

namespace headway::sim {

/// What a stretch's random numbers are drawn for; each has a seed of its own.
enum StretchPurpose : std::uint64_t {
  kGroundSeed = 1,
  kHouseSeed,
  kFurnitureSeed,
  kParkedSeed,
  kFenceSeed
};

[[nodiscard]] inline std::uint64_t stretchSeed(const WorldParams& params, const StretchKey& key,
                                               StretchPurpose purpose, std::uint64_t side = 0) {
  return seedOf({static_cast<std::uint64_t>(params.seed), key.road,
                 static_cast<std::uint64_t>(key.number), purpose, side});
}

/// Coordinates along and beside one stretch.
struct StreetBuilder::Site {
  StretchKey key;
  const Road& road;
  double begin = 0.0;   ///< along the street's axis [m]
  double length = 0.0;  ///< [m]
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();

  [[nodiscard]] Eigen::Vector3d world(double s, double left) const {
    return road.axis.beside(s, left);
  }
  /// Relative to the anchor.
  [[nodiscard]] Eigen::Vector3f local(double s, double left, double up) const {
    return (world(s, left) + Eigen::Vector3d(0, 0, up) - anchor).cast<float>();
  }
  /// Cells of ground along the stretch.
  [[nodiscard]] int groundSteps() const {
    return std::max(1, static_cast<int>(std::lround(length / 2.0)));
  }
  [[nodiscard]] float yaw(double s) const { return static_cast<float>(road.axis.at(s).yaw); }
  [[nodiscard]] bool drawn(double s) const {
    const auto i = static_cast<std::size_t>(std::max(0.0, s));
    return i < road.drawn.size() && road.drawn[i];
  }
};

/// A cell of the ground: number along the stretch; its two edges as (left, up, left, up) [m].
struct StreetBuilder::GroundCell {
  int step = 0;
  std::array<double, 4> edges{};
};

}  // namespace headway::sim
