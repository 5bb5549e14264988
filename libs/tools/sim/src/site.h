// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/sim/simulator.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <vector>

#include "actor.h"
#include "material.h"
#include "mesh.h"

namespace headway::sim {

/// A rectangle on the ground, turned by yaw.
struct Footprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< world [m]
  Eigen::Vector2d size = Eigen::Vector2d::Ones();    ///< along yaw and across it [m]
  double yaw = 0.0;                                  ///< [rad]
};

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
[[nodiscard]] Site makeHall(const Grain& grain, std::uint64_t seed);
/// Outdoor paths with hedges, railings and bicycles between houses; stairs down; a roadway between
/// kerbs that are lowered to ramps here and there.
[[nodiscard]] Site makeCampus(const Grain& grain, std::uint64_t seed);
/// Racks with pallets, painted aisles, forklifts, a loading dock.
[[nodiscard]] Site makeWarehouse(const Grain& grain, std::uint64_t seed);

}  // namespace headway::sim
