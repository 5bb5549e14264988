// SPDX-License-Identifier: BSD-3-Clause
// Everything around the cameras, as the simulator uses it.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/sim/driven_world.h>
#include <headway/sim/simulator.h>

#include <memory>
#include <vector>

#include "actor.h"
#include "stereo_rig.h"

namespace headway::sim {

/// A mesh and the place that its vertices are relative to.
struct PlacedMesh {
  const Mesh* mesh = nullptr;
  Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  ///< world [m]
};

class WheeledRobot;

/// Everything around the cameras: static geometry, the robot that carries them, and all others who
/// move.
class Environment {
 public:
  virtual ~Environment() = default;

  virtual void advance(double dt) = 0;
  /// The camera takes a frame.
  virtual void observe() {}

  [[nodiscard]] virtual Pose T_world_robot() const = 0;
  /// Whether the robot is at the end of its path.
  [[nodiscard]] virtual bool arrived() const = 0;
  /// Length of the path [m]; 0 if it never ends.
  [[nodiscard]] virtual double pathLength() const = 0;

  /// Actors within `reach` metres of the robot, and possibly others.
  [[nodiscard]] virtual std::vector<Actor> actors(double reach) = 0;
  /// Static surfaces within `reach` metres of the robot, for range sensors; valid until the next
  /// call of any function.
  [[nodiscard]] virtual std::vector<PlacedMesh> staticMeshes(double reach) = 0;
  /// Edges that a robot must not drive over, world frame.
  [[nodiscard]] virtual std::vector<Drop> drops() const { return {}; }

  /// The robot if it is driven from outside; else null.
  [[nodiscard]] virtual WheeledRobot* drivenRobot() { return nullptr; }
  /// What a robot that is driven from outside cannot pass, world frame.
  [[nodiscard]] virtual std::vector<Footprint> things() const { return {}; }

  /// @param camera  left camera without distortion; the right one sees as far
  [[nodiscard]] virtual std::unique_ptr<Scene> makeScene(const StereoCamera& camera) = 0;
};

/// Who drives the robot.
enum class Driver {
  kItself,  ///< from stop to stop, or along its lane
  kCaller,  ///< along a course on which it meets people
};

/// Streets through a town, and the traffic on them.
///
/// @param camera  in whose left image the escort covers its ratio
[[nodiscard]] std::unique_ptr<Environment> makeStreetEnvironment(const SimParams& params,
                                                                 const StereoCamera& camera,
                                                                 Driver driver);

/// The environment that [world] kind names.
///
/// @param camera  as recorded
/// @throws InputError naming the key of parameters that cannot be
[[nodiscard]] std::unique_ptr<Environment> makeEnvironment(const SimParams& params,
                                                           const StereoCamera& camera,
                                                           Driver driver = Driver::kItself);

}  // namespace headway::sim
