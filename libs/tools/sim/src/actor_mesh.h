// SPDX-License-Identifier: BSD-3-Clause
// Meshes of people, cyclists, vehicles and machines.
#pragma once

#include <vector>

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// The mesh of any actor, placed in the world relative to `origin`.
[[nodiscard]] Mesh actorMesh(const Actor& actor, const Eigen::Vector3d& origin);
[[nodiscard]] std::vector<Mesh> actorMeshes(const std::vector<Actor>& actors,
                                            const Eigen::Vector3d& origin);

/// A car, van, truck or bus, x forward, z up, origin on the ground below its middle [m].
///
/// Its extent is the actor's size: outline extruded over the width, leaning inwards above the belt.
[[nodiscard]] Mesh vehicleMesh(const Actor& actor);

/// A walking (or standing) person, x forward, z up, origin on the ground below the hips [m].
///
/// Hips, knees, shoulders and elbows swing with actor.gait; how far depends on actor.speed.
/// @see Winter 1991, "The Biomechanics and Motor Control of Human Gait": hip about +-25 degrees
///      and knee up to 60 degrees at normal speed
[[nodiscard]] Mesh personMesh(const Actor& actor);

/// A cyclist: bicycle and pedalling rider, origin on the ground below the middle.
[[nodiscard]] Mesh cyclistMesh(const Actor& actor);

/// A person on a chair, x forward, z up, origin on the ground below the knees' middle [m].
[[nodiscard]] Mesh seatedMesh(const Actor& actor);

/// A bicycle alone, origin on the ground below the middle.
[[nodiscard]] Mesh bicycleMesh(int look);

/// A counterbalanced forklift with a driver's cage, x forward, z up, origin on the ground below its
/// middle [m]. Its extent, forks included, is the actor's size.
[[nodiscard]] Mesh forkliftMesh(const Actor& actor);

/// A small six-wheeled delivery robot with a flag.
[[nodiscard]] Mesh deliveryRobotMesh(const Actor& actor);

/// Outline of a vehicle's side: ratios of its length (from the rear) and of its height.
struct OutlinePoint {
  double x = 0.0;
  double z = 0.0;
};

/// What makes a vehicle of one kind: outline of its top, and where its wheels are.
struct VehicleShape {
  std::vector<OutlinePoint> outline;  ///< from the rear to the front
  double floor = 0.18;                ///< lower edge of the body, ratio of the height
  double belt = 0.6;                  ///< below it the body is straight, above it leans inwards
  double lean = 0.8;                  ///< width at the top, ratio of the full width
  double rear_wheel = 0.19;           ///< ratio of the length
  double front_wheel = 0.8;
  double wheel_radius_m = 0.32;
};

/// @param look  cars come as saloon, hatchback and estate
[[nodiscard]] const VehicleShape& shapeOf(ActorKind kind, int look);

}  // namespace headway::sim
