// SPDX-License-Identifier: BSD-3-Clause
// What moves or is parked: its kind, size and state at one instant.
#pragma once

#include <headway/core/object_class.h>
#include <headway/core/random.h>
#include <headway/sim/simulator.h>

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace headway::sim {

/// Shapes that the simulator can draw.
enum class ActorKind {
  kCar,
  kVan,
  kTruck,
  kBus,
  kCyclist,
  kPedestrian,
  kSeatedPerson,
  kForklift,
  kDeliveryRobot,
  kBicycle
};

/// KITTI's class of a shape (a bus counts as Truck: KITTI has no word for it).
[[nodiscard]] ObjectClass classOf(ActorKind kind);

/// Whether its mesh is closed, so that only fronts can be seen.
[[nodiscard]] bool isClosed(ActorKind kind);
/// Whether it is a person on foot or seated.
[[nodiscard]] bool isPerson(ActorKind kind);

/// How a person differs from the usual one.
struct PersonBody {
  enum class Load { kNone, kCarried, kPushed };

  double girth = 1.0;       ///< width of torso and limbs, by that of the usual one
  double bend_rad = 0.0;    ///< of the trunk, forward
  Load load = Load::kNone;  ///< a box before the chest, or a trolley
  bool wheelchair = false;  ///< of a seated person
};

/// One thing with a truth box, moving or parked, at one instant.
struct Actor {
  std::int64_t id = -1;
  ActorKind kind = ActorKind::kCar;
  int look = 0;     ///< which picture of the atlas it wears, any number >= 0
  PersonBody body;  ///< of a person
  Eigen::Vector3d size = Eigen::Vector3d::Ones();  ///< length, width, height [m]
  Eigen::Vector3d position =
      Eigen::Vector3d::Zero();  ///< on the ground below its middle, world [m]
  double yaw = 0.0;             ///< of its front about world z [rad]
  double speed = 0.0;           ///< along its front [m/s]
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< world [m/s]
  double gait = 0.0;                                   ///< phase of walking or pedalling [rad]
  bool parked = false;                                 ///< never moves

  [[nodiscard]] Eigen::Vector3d centre() const {
    return position + Eigen::Vector3d(0.0, 0.0, 0.5 * size.z());
  }
};

/// What a forklift looks like from above.
struct ForkliftShape {
  double mast_ratio = 0.62;  ///< from the rear to the mast
  double carriage_m = 0.14;  ///< from there to the end of what is as wide as the body
  double fork_m = 0.25;      ///< to each side, from the middle to that of a fork
  double fork_width_m = 0.12;
};
inline constexpr ForkliftShape kForklift;

/// What a kind of some extent takes of the ground: of a forklift body and forks, of others all.
[[nodiscard]] std::vector<Footprint> partsOf(ActorKind kind, const Footprint& extent);

/// A size drawn from what the kind measures in traffic.
[[nodiscard]] Eigen::Vector3d drawSize(ActorKind kind, Random& random);
/// An actor with picture and size of its own, nowhere yet.
[[nodiscard]] Actor drawActor(ActorKind kind, std::int64_t id, Random& random);
/// Gives a person on foot or seated another body: 1.1 to 2.0 m high, slim or broad, upright or
/// bent, carrying, pushing, or in a wheelchair.
void varyBody(Random& random, Actor& actor);
/// Lets the limbs of a walking person swing on: one cycle is two steps, about 1.4 m at normal
/// speed, less when slow.
void swingLimbs(double dt, Actor& actor);

}  // namespace headway::sim
