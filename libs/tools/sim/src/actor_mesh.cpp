// SPDX-License-Identifier: BSD-3-Clause
#include "actor_mesh.h"

#include <Eigen/Geometry>
#include <utility>

namespace headway::sim {
namespace {

/// In the actor's own frame.
Mesh ownMesh(const Actor& actor) {
  switch (actor.kind) {
    case ActorKind::kPedestrian:
      return personMesh(actor);
    case ActorKind::kSeatedPerson:
      return seatedMesh(actor);
    case ActorKind::kCyclist:
      return cyclistMesh(actor);
    case ActorKind::kBicycle:
      return bicycleMesh(actor.look);
    case ActorKind::kForklift:
      return forkliftMesh(actor);
    case ActorKind::kDeliveryRobot:
      return deliveryRobotMesh(actor);
    case ActorKind::kCar:
    case ActorKind::kVan:
    case ActorKind::kTruck:
    case ActorKind::kBus:
      break;
  }
  return vehicleMesh(actor);
}

}  // namespace

Mesh actorMesh(const Actor& actor, const Eigen::Vector3d& origin) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(actor.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return moved(ownMesh(actor), turn.cast<float>(), (actor.position - origin).cast<float>());
}

std::vector<Mesh> actorMeshes(const std::vector<Actor>& actors, const Eigen::Vector3d& origin) {
  std::vector<Mesh> meshes;
  meshes.reserve(actors.size());
  for (const Actor& actor : actors) meshes.push_back(actorMesh(actor, origin));
  return meshes;
}

}  // namespace headway::sim
