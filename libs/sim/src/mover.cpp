#include "mover.h"

#include <headway/core/random.h>

namespace headway::sim {

ObjectClass classOf(MoverKind kind) {
  switch (kind) {
    case MoverKind::kCar:
      return ObjectClass::kCar;
    case MoverKind::kVan:
      return ObjectClass::kVan;
    case MoverKind::kTruck:
    case MoverKind::kBus:
      return ObjectClass::kTruck;
    case MoverKind::kCyclist:
      return ObjectClass::kCyclist;
    case MoverKind::kPedestrian:
      return ObjectClass::kPedestrian;
  }
  return ObjectClass::kUnknown;
}

Eigen::Vector3d drawSize(MoverKind kind, Random& random) {
  switch (kind) {
    case MoverKind::kCar:
      return {random.uniform(3.7, 4.7), random.uniform(1.65, 1.85), random.uniform(1.42, 1.6)};
    case MoverKind::kVan:
      return {random.uniform(4.7, 5.6), random.uniform(1.9, 2.05), random.uniform(1.95, 2.45)};
    case MoverKind::kTruck:
      return {random.uniform(6.5, 8.5), random.uniform(2.3, 2.5), random.uniform(2.9, 3.4)};
    case MoverKind::kBus:
      return {12.0, 2.55, 3.1};
    case MoverKind::kCyclist:
      return {1.8, 0.6, random.uniform(1.68, 1.85)};
    case MoverKind::kPedestrian:
      return {0.8, 0.6, random.uniform(1.55, 1.92)};
  }
  return Eigen::Vector3d::Ones();
}

}  // namespace headway::sim
