// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "grain.h"
#include "road_network.h"
#include "street_stretch.h"
#include "view_cone.h"

namespace headway::sim {

/// The static part of a world: streets with everything along them, built as they come into view.
///
/// What a place looks like depends on the seed alone, not on when or how often it is built. What is
/// looked up, built and kept grows with what is in view, not with the length of the streets.
class World {
 public:
  World(const WorldParams& params, const Route& route);

  [[nodiscard]] const RoadNetwork& network() const { return network_; }
  [[nodiscard]] const WorldParams& params() const { return params_; }

  /// Stretches within view of a camera, the nearest first; builds what is missing.
  [[nodiscard]] std::vector<StretchKey> inView(const Eigen::Vector3d& viewpoint,
                                               const ViewCone& view);
  /// A stretch that inView() named last time or the time before.
  [[nodiscard]] const StreetStretch& stretch(const StretchKey& key) const;
  /// Stretches that are built at present.
  [[nodiscard]] const std::map<StretchKey, StreetStretch>& built() const { return built_; }
  /// Vehicles parked within `reach` metres of a place.
  [[nodiscard]] std::vector<Actor> parkedNear(const Eigen::Vector3d& place, double reach);

  [[nodiscard]] const Grain& grain() const { return grain_; }

 private:
  struct Spot {
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();  ///< [m]
    StretchKey key;
  };
  using Cell = std::pair<int, int>;

  [[nodiscard]] static Cell cellOf(const Eigen::Vector2d& xy);
  /// Stretches whose middle is within `reach` metres, in the order of their keys.
  [[nodiscard]] std::vector<Spot> spotsNear(const Eigen::Vector3d& place, double reach) const;

  WorldParams params_;
  Grain grain_;
  RoadNetwork network_;
  StreetBuilder builder_;
  std::map<Cell, std::vector<Spot>> spots_;  ///< all stretches, by the cell of their middle
  std::map<StretchKey, StreetStretch> built_;
  std::map<StretchKey, std::vector<Actor>> parked_;
};

}  // namespace headway::sim
