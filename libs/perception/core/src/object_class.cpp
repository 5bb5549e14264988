// SPDX-License-Identifier: BSD-3-Clause
// Classes of objects: names, colours, kinds.
#include <headway/core/object_class.h>

#include <array>

namespace headway {
namespace {

constexpr std::array<std::string_view, kObjectClassCount> kNames = {
    "Unknown", "Car", "Van", "Truck", "Pedestrian", "Person_sitting", "Cyclist", "Tram", "Misc"};

}  // namespace

std::string_view toString(ObjectClass object_class) {
  return kNames.at(static_cast<std::size_t>(object_class));
}

std::string_view displayName(ObjectClass object_class) {
  return object_class == ObjectClass::kPersonSitting ? "Sitting person" : toString(object_class);
}

std::optional<ObjectClass> objectClassFrom(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<ObjectClass>(i);
  }
  return std::nullopt;
}

bool isVehicle(ObjectClass object_class) {
  return object_class == ObjectClass::kCar || object_class == ObjectClass::kVan ||
         object_class == ObjectClass::kTruck || object_class == ObjectClass::kTram;
}

}  // namespace headway
