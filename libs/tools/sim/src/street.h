// SPDX-License-Identifier: BSD-3-Clause
// Streets: their stretches with houses and parked vehicles, built as they come into view.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/sim/sim_params.h>

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <memory>
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

/// Side of one picture of the meadow [m].
inline constexpr double kMeadowCell = 16.0;

/// A wide plain a little below the streets, for where no street is near.
///
/// @param corner  number of the cell below the camera, in x and y
/// @param anchor  what the mesh is relative to
[[nodiscard]] Mesh plainMesh(const RoadNetwork& network, const Eigen::Vector2i& corner,
                             const Eigen::Vector3d& anchor);

/// What a camera can see of the ground plan: all within an angle of its viewing direction.
struct ViewCone {
  Eigen::Vector2d viewpoint = Eigen::Vector2d::Zero();  ///< world [m]
  double heading = 0.0;                                 ///< about world z [rad]
  double half_width = M_PI;                             ///< half the horizontal field of view [rad]

  /// Whether any of a disc is seen.
  [[nodiscard]] bool touches(const Eigen::Vector2d& middle, double radius) const {
    const Eigen::Vector2d offset = middle - viewpoint;
    const double distance = offset.norm();
    if (distance <= radius) return true;
    const double off_axis =
        std::abs(std::remainder(std::atan2(offset.y(), offset.x()) - heading, 2.0 * M_PI));
    return off_axis < half_width + std::asin(radius / distance);
  }
};

/// What a camera on the robot sees, and a little more.
[[nodiscard]] inline ViewCone viewCone(const StereoCamera& camera, const Pose& T_world_robot) {
  const Eigen::Vector3d viewpoint = (T_world_robot * camera.T_robot_cam).translation();
  return {viewpoint.head<2>(), yawOf(T_world_robot),
          std::atan(0.5 * camera.width / camera.fx) + 0.02};
}

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
