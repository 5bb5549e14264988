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

/// KITTI's spelling: "Car", "Person_sitting"; "Unknown" for what KITTI has no word for.
[[nodiscard]] std::string_view toString(ObjectClass object_class);

/// Inverse of toString, exact spelling; nullopt for any other word ("DontCare" included).
[[nodiscard]] std::optional<ObjectClass> objectClassFrom(std::string_view name);

/// Car, Van, Truck, Tram: things on wheels with a body that hides their driver.
[[nodiscard]] bool isVehicle(ObjectClass object_class);

}  // namespace headway
