// SPDX-License-Identifier: BSD-3-Clause
// A place that robots work in, and the builder of its surfaces and obstacles.
#pragma once

#include <headway/sim/simulator.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <vector>

#include "actor.h"
#include "mesh.h"
#include "textures.h"

namespace headway::sim {

/// Where somebody sits or stands, and where they face.
struct Spot {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< world [m]
  double yaw = 0.0;                                    ///< [rad]
  bool seat = false;
};

/// A strip across the floor that wheels bump over, such as the threshold of a door.
struct Threshold {
  Footprint strip;         ///< size: along the way over it, and its length
  double height_m = 0.01;  ///< above the floor
};

/// A closed line that vehicles of one kind go round.
struct VehicleLoop {
  ActorKind kind = ActorKind::kForklift;
  std::vector<Eigen::Vector3d> points;  ///< closed, without the first repeated [m]
  double speed_mps = 1.5;
};

/// A surface with a picture of its own.
struct PicturedMesh {
  cv::Mat picture;  ///< BGR
  Mesh mesh;
};

/// One place that robots work in: its static geometry, and where everybody can be.
///
/// The floor is at height 0 but for `ground`. All of it is in the world frame.
struct Site {
  std::map<Material, Mesh> surfaces;  ///< texture coordinates in pictures; they repeat
  std::vector<PicturedMesh> facades;  ///< houses
  Mesh furniture;                     ///< trees and the like, in the furniture atlas
  bool outdoors = false;              ///< a meadow lies around it
  Eigen::AlignedBox2d area;           ///< all motion stays inside
  std::vector<Footprint> obstacles;   ///< impassable: walls, furniture
  std::vector<Footprint> edges;       ///< impassable, with nothing on the floor: drops, kerbs
  std::vector<Drop> drops;
  std::vector<Threshold> thresholds;
  std::vector<std::array<Eigen::Vector3d, 3>> ground;  ///< triangles of roadways and ramps [m]
  std::vector<Eigen::Vector2d> destinations;           ///< of people
  std::vector<Spot> spots;                             ///< of idle people
  std::vector<Eigen::Vector2d> robot_stops;  ///< places that the robot drives to; it starts at
                                             ///< the first
  std::vector<VehicleLoop> loops;
  std::vector<Spot> bicycles;  ///< parked
};

/// Height of the ground, without thresholds [m].
[[nodiscard]] double groundHeight(const Site& site, const Eigen::Vector2d& at);

/// Height of a wheel that rolls over ground and thresholds [m].
[[nodiscard]] double wheelHeight(const Site& site, const Eigen::Vector2d& at);

/// An office floor: corridor, rooms with furniture, windows, a lobby with stairs down.
[[nodiscard]] Site makeHall(const WorldParams& params, const Grain& grain, std::uint64_t seed);
/// Outdoor paths with hedges, railings and bicycles between houses; stairs down; a roadway between
/// kerbs that are lowered to ramps here and there.
[[nodiscard]] Site makeCampus(const WorldParams& params, const Grain& grain, std::uint64_t seed);
/// Racks with pallets, painted aisles, forklifts, a loading dock.
[[nodiscard]] Site makeWarehouse(const WorldParams& params, const Grain& grain, std::uint64_t seed);

/// A piece of a wall that is missing between two heights: a door, a window.
struct Opening {
  double at_m = 0.0;  ///< its middle, along the wall
  double width_m = 1.0;
  double bottom_m = 0.0;
  double top_m = 2.1;
};

/// An upright box standing at `base_m`, turned by yaw.
struct BoxShape {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< world [m]
  double yaw = 0.0;                                  ///< [rad]
  Eigen::Vector3d size = Eigen::Vector3d::Ones();    ///< along yaw, across, up [m]
  double base_m = 0.0;
};

/// Puts boxes, walls and floors into a site: their surfaces, and what they block.
class SiteBuilder {
 public:
  /// @param seed  of what stands otherwise than planned, by WorldParams::moved_ratio
  SiteBuilder(Site& site, const WorldParams& params, std::uint64_t seed)
      : site_(site), moved_ratio_(params.moved_ratio), moves_(seedOf({seed, 511})) {}
  explicit SiteBuilder(Site& site) : SiteBuilder(site, {}, 0) {}

  /// Whether the next piece is otherwise than planned.
  [[nodiscard]] bool isMoved() { return moved_ratio_ > 0.0 && moves_.chance(moved_ratio_); }
  /// Where a piece of furniture stands that is planned there: if it is moved, some decimetres
  /// along its own y axis, and turned.
  [[nodiscard]] Spot placed(const Spot& planned);
  /// Of what is otherwise than planned.
  [[nodiscard]] Random& moves() { return moves_; }

  /// A box, impassable if it reaches into the room that people and robots take.
  void box(const BoxShape& shape, Material material);
  /// The same without blocking anybody: lamps, posters, paint, what stands on furniture.
  void ornament(const BoxShape& shape, Material material);
  /// A box in coordinates of a piece of furniture: `at` is its middle, x along yaw.
  void part(const Spot& origin, const Eigen::Vector2d& at, const Eigen::Vector3d& size,
            double base_m, Material material);

  /// Level ground over a rectangle, with rectangular holes.
  void floor(const Eigen::AlignedBox2d& area, double height_m, Material material,
             const std::vector<Eigen::AlignedBox2d>& holes = {});
  /// Ground that is not at height 0: recorded, and drawn with its outline convex and clockwise from
  /// above.
  void slope(const std::vector<Eigen::Vector3d>& outline, Material material);
  /// The underside of a ceiling.
  void ceiling(const Eigen::AlignedBox2d& area, double height_m, Material material);
  /// A wall around openings, with skirting boards and window frames.
  void wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double height_m,
            Material material, const std::vector<Opening>& openings = {});
  /// An impassable pit, recorded as a drop, with walls and a bottom.
  void pit(const Eigen::AlignedBox2d& area, double depth_m, Material material);
  /// Steps down into a pit along +x or -x; the pit's floor is not theirs.
  void stairsDown(const Eigen::AlignedBox2d& area, double depth_m, bool towards_positive_x,
                  Material material);
  /// Posts and bars between two points.
  void railing(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Material material);
  /// A strip that wheels bump over.
  void threshold(const Eigen::Vector2d& centre, double yaw, double length_m, double height_m);
  void block(const Footprint& footprint) { site_.obstacles.push_back(footprint); }

  /// An impassable edge at which nothing stands on the floor.
  void barEdge(const Footprint& footprint) { site_.edges.push_back(footprint); }
  [[nodiscard]] Site& site() { return site_; }

 private:
  void wallPart(const Eigen::Vector2d& from, const Eigen::Vector2d& along, double begin, double end,
                double bottom, double top, Material material);
  void quad(const std::array<Eigen::Vector3d, 4>& corners, const Eigen::Vector3d& right,
            const Eigen::Vector3d& down, Material material);

  Site& site_;
  double moved_ratio_;
  Random moves_;
};

/// The rectangle between two corners.
[[nodiscard]] Eigen::AlignedBox2d rectangle(double x0, double y0, double x1, double y1);

/// A kerb along x between a pavement at height 0 and a roadway below it, lowered to ramps.
///
/// A ramp is 1.8 m wide and 1.25 m long; its flared sides take 0.35 m more on either side.
struct Kerb {
  static constexpr double kHalfRamp = 0.9, kFlare = 0.35, kRun = 1.25;  // [m]

  double y = 0.0;         ///< edge of the roadway [m]
  double pavement = 1.0;  ///< +1 if the pavement lies towards +y, -1 if towards -y
  double height_m = 0.1;  ///< pavement above the roadway; with kRun an 8 % slope
  double from_x = 0.0, to_x = 10.0;
  std::vector<double> ramps;  ///< their middles, x, ascending [m]

  /// Ground that the ramps take from the pavement.
  [[nodiscard]] std::vector<Eigen::AlignedBox2d> rampAreas() const;
};

/// Lays stones and ramps; the kerb is impassable but for the ramps.
void addKerb(SiteBuilder& builder, const Kerb& kerb);

}  // namespace headway::sim
