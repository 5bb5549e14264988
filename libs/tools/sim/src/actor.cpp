// SPDX-License-Identifier: BSD-3-Clause
// What moves or is parked: its kind, size and state at one instant.
#include "actor.h"

#include <algorithm>
#include <cmath>

namespace headway::sim {

ObjectClass classOf(ActorKind kind) {
  switch (kind) {
    case ActorKind::kCar:
      return ObjectClass::kCar;
    case ActorKind::kVan:
      return ObjectClass::kVan;
    case ActorKind::kTruck:
    case ActorKind::kBus:
      return ObjectClass::kTruck;
    case ActorKind::kCyclist:
      return ObjectClass::kCyclist;
    case ActorKind::kPedestrian:
      return ObjectClass::kPedestrian;
    case ActorKind::kSeatedPerson:
      return ObjectClass::kPersonSitting;
    case ActorKind::kForklift:
    case ActorKind::kDeliveryRobot:
    case ActorKind::kBicycle:
      return ObjectClass::kMisc;
  }
  return ObjectClass::kUnknown;
}

bool isClosed(ActorKind kind) {
  return kind != ActorKind::kCyclist && kind != ActorKind::kBicycle && !isPerson(kind);
}

bool isPerson(ActorKind kind) {
  return kind == ActorKind::kPedestrian || kind == ActorKind::kSeatedPerson;
}

std::vector<Footprint> partsOf(ActorKind kind, const Footprint& extent) {
  if (kind != ActorKind::kForklift) return {extent};
  const Eigen::Vector2d ahead(std::cos(extent.yaw), std::sin(extent.yaw));
  const auto part = [&](double from, double to, double width) -> Footprint {
    return {extent.centre + 0.5 * (from + to) * ahead, {to - from, width}, extent.yaw};
  };
  const double front = 0.5 * extent.size.x();
  const double body = kForklift.mast_ratio * extent.size.x() - front + kForklift.carriage_m;
  return {part(-front, body, extent.size.y()),
          part(body, front, 2.0 * kForklift.fork_m + kForklift.fork_width_m)};
}

Eigen::Vector3d drawSize(ActorKind kind, Random& random) {
  switch (kind) {
    case ActorKind::kCar:
      return {random.uniform(3.7, 4.7), random.uniform(1.65, 1.85), random.uniform(1.42, 1.6)};
    case ActorKind::kVan:
      return {random.uniform(4.7, 5.6), random.uniform(1.9, 2.05), random.uniform(1.95, 2.45)};
    case ActorKind::kTruck:
      return {random.uniform(6.5, 8.5), random.uniform(2.3, 2.5), random.uniform(2.9, 3.4)};
    case ActorKind::kBus:
      return {12.0, 2.55, 3.1};
    case ActorKind::kCyclist:
      return {1.8, 0.6, random.uniform(1.68, 1.85)};
    case ActorKind::kPedestrian:
      return {0.8, 0.6, random.uniform(1.55, 1.92)};
    case ActorKind::kSeatedPerson:
      return {0.9, 0.55, random.uniform(1.22, 1.4)};
    case ActorKind::kForklift:
      return {3.2, 1.15, 2.15};
    case ActorKind::kBicycle:
      return {1.8, 0.56, 0.98};
    case ActorKind::kDeliveryRobot:
      return {0.7, 0.55, random.uniform(0.6, 0.75)};
  }
  return Eigen::Vector3d::Ones();
}

Actor drawActor(ActorKind kind, std::int64_t id, Random& random) {
  Actor actor;
  actor.id = id;
  actor.kind = kind;
  actor.look = random.below(100000);
  actor.size = drawSize(kind, random);
  return actor;
}

void varyBody(Random& random, Actor& actor) {
  const double height = random.uniform(1.1, 2.0);
  actor.body.girth = random.uniform(0.85, 1.5);
  const int kind = random.below(8);
  if (actor.kind == ActorKind::kPedestrian && kind == 0) actor.kind = ActorKind::kSeatedPerson;
  if (actor.kind == ActorKind::kSeatedPerson) {
    actor.body.wheelchair = kind == 0;
    actor.size = drawSize(actor.kind, random);
    actor.size.z() = 0.5 + 0.47 * height;  // as in seatedMesh()
    return;
  }
  actor.size.z() = height;
  if (kind == 1) actor.body.bend_rad = random.uniform(0.3, 1.1);
  if (kind == 2 || kind == 3) actor.body.load = PersonBody::Load::kCarried;
  if (kind == 4) actor.body.load = PersonBody::Load::kPushed;
}

void swingLimbs(double dt, Actor& actor) {
  actor.gait += 2.0 * M_PI * actor.speed * dt / (0.55 + 0.62 * std::max(0.3, actor.speed));
}

}  // namespace headway::sim
