// SPDX-License-Identifier: BSD-3-Clause
// Classes of objects: names, colours, kinds.
#pragma once

#include <array>
#include <cstdint>
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

/// A colour, 0 to 255 each.
struct Colour {
  std::uint8_t red = 0;
  std::uint8_t green = 0;
  std::uint8_t blue = 0;
};

/// The colour of each class, the same in 3D scenes, pictures, plots and the report.
///
/// Distinguishable on dark and light backgrounds and with the common kinds of colour blindness;
/// green is reserved for predictions (kPredictionColour).
[[nodiscard]] constexpr Colour colourOf(ObjectClass object_class) {
  constexpr std::array<Colour, kObjectClassCount> kColours = {{
      {176, 182, 192},  // Unknown         light grey
      {56, 163, 255},   // Car             blue
      {74, 116, 224},   // Van             deep blue
      {158, 112, 255},  // Truck           violet
      {255, 150, 32},   // Pedestrian      orange
      {255, 196, 92},   // Person_sitting  sand
      {255, 84, 132},   // Cyclist         rose
      {214, 84, 232},   // Tram            magenta
      {150, 140, 120},  // Misc            taupe
  }};
  return kColours[static_cast<std::size_t>(object_class)];
}

/// Of predicted paths of every class.
inline constexpr Colour kPredictionColour{64, 222, 104};

/// Of true paths and boxes.
inline constexpr Colour kTruthColour{240, 240, 240};

/// Name of a class for people, in pictures and pages: "Car", "Sitting person".
[[nodiscard]] std::string_view displayName(ObjectClass object_class);

}  // namespace headway
