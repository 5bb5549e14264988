// SPDX-License-Identifier: BSD-3-Clause
// Values that depend on the class of an object.
#pragma once

#include <headway/core/object_class.h>

namespace headway::objects {

/// Classes with common motion parameters.
enum class MotionGroup { kVehicle, kCyclist, kPedestrian, kOther };

/// Number of enumerators of MotionGroup.
inline constexpr int kMotionGroupCount = 4;

/// Vehicles as defined by isVehicle(); Pedestrian and Person_sitting; Cyclist; Misc and Unknown.
[[nodiscard]] constexpr MotionGroup motionGroupOf(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kCar:
    case ObjectClass::kVan:
    case ObjectClass::kTruck:
    case ObjectClass::kTram:
      return MotionGroup::kVehicle;
    case ObjectClass::kCyclist:
      return MotionGroup::kCyclist;
    case ObjectClass::kPedestrian:
    case ObjectClass::kPersonSitting:
      return MotionGroup::kPedestrian;
    case ObjectClass::kMisc:
    case ObjectClass::kUnknown:
      return MotionGroup::kOther;
  }
  return MotionGroup::kOther;
}

/// One value per motion group; kOther uses the cyclists' value.
template <typename T>
struct PerClass {
  T vehicle;
  T cyclist;
  T pedestrian;

  [[nodiscard]] const T& of(MotionGroup group) const {
    if (group == MotionGroup::kVehicle) return vehicle;
    return group == MotionGroup::kPedestrian ? pedestrian : cyclist;
  }
  [[nodiscard]] const T& of(ObjectClass object_class) const {
    return of(motionGroupOf(object_class));
  }
};

}  // namespace headway::objects
