// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string_view>

namespace headway {

/// Kinds of moving objects, KITTI's eight and an unknown one.
enum class ObjectClass {
  kUnknown,
  kCar,
  kVan,
  kTruck,
  kPedestrian,
  kPersonSitting,
  kCyclist,
  kTram,
  kMisc,
};

/// Number of enumerators of ObjectClass.
inline constexpr int kObjectClassCount = 9;

/// KITTI's spelling: "Car", "Person_sitting"; "Unknown" for all other classes.
[[nodiscard]] std::string_view toString(ObjectClass object_class);

/// Inverse of toString, exact spelling; nullopt for any other word ("DontCare" included).
[[nodiscard]] std::optional<ObjectClass> objectClassFrom(std::string_view name);

/// Car, Van, Truck or Tram.
[[nodiscard]] bool isVehicle(ObjectClass object_class);

}  // namespace headway
