// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/sim/sim_params.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "actor.h"
#include "grain.h"
#include "mesh.h"
#include "occlusion.h"
#include "road_network.h"

namespace headway::sim {

/// Length of the piece of street that is built at a time [m].
inline constexpr double kStretch = 24.0;

/// A surface with a picture of its own.
struct Surface {
  cv::Mat picture;             ///< BGR
  Mesh mesh;                   ///< relative to the stretch's anchor
  std::optional<Block> block;  ///< a house's walls; a house is closed: only fronts can be seen
};

/// Everything that stands along kStretch metres of one street.
struct StreetStretch {
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< world; meshes are relative to it
  std::vector<Surface> surfaces;                     ///< the ground, and each house
  std::vector<Mesh> furniture;  ///< trees, lamps, hedges: in the furniture atlas
  Mesh verges;                  ///< unpaved ground beside the street: in the meadow picture
};

/// Which stretch: street, and number of the stretch along it.
struct StretchKey {
  std::size_t road = 0;
  int number = 0;
  friend bool operator<(const StretchKey& a, const StretchKey& b) {
    return a.road != b.road ? a.road < b.road : a.number < b.number;
  }
  friend bool operator==(const StretchKey& a, const StretchKey& b) {
    return a.road == b.road && a.number == b.number;
  }
};

/// Builds stretches of a world. Each depends on the world's seed and its key alone.
class StreetBuilder {
 public:
  /// The network must outlive the builder.
  StreetBuilder(const RoadNetwork& network, const WorldParams& params, const Grain& grain);

  [[nodiscard]] StreetStretch build(const StretchKey& key) const;
  /// Vehicles parked along the stretch. Ids are unique in the world.
  [[nodiscard]] std::vector<Actor> parked(const StretchKey& key) const;
  /// Middle of a stretch, and whether any of it is drawn.
  [[nodiscard]] Eigen::Vector3d middle(const StretchKey& key) const;
  [[nodiscard]] bool exists(const StretchKey& key) const;

 private:
  struct Site;
  struct GroundCell;
  /// @param reach         no cell where another street's middle is as near [m]
  /// @param earlier_only  consider only streets that were laid before
  void layCell(const Site& site, const GroundCell& cell, double reach, bool earlier_only,
               Mesh& mesh) const;
  void layGround(const Site& site, StreetStretch& stretch, Random& random) const;
  void layVerges(const Site& site, StreetStretch& stretch) const;
  void buildHouses(const Site& site, double side, StreetStretch& stretch, Random& random) const;
  void placeFences(const Site& site, StreetStretch& stretch) const;
  void placeFurniture(const Site& site, StreetStretch& stretch, Random& random) const;
  [[nodiscard]] bool isFree(const Site& site, double s, double left, double margin) const;

  const RoadNetwork& network_;
  WorldParams params_;
  const Grain& grain_;
};

}  // namespace headway::sim
