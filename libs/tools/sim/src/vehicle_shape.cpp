// SPDX-License-Identifier: BSD-3-Clause
#include "vehicle_shape.h"

#include <array>

namespace headway::sim {
namespace {

const std::array<VehicleShape, 3> kCars = {{
    {{{0.0, 0.38},
      {0.01, 0.6},
      {0.14, 0.66},
      {0.27, 0.94},
      {0.36, 1.0},
      {0.55, 0.99},
      {0.7, 0.67},
      {0.95, 0.55},
      {1.0, 0.36}}},
    {{{0.0, 0.35},
      {0.01, 0.62},
      {0.05, 0.72},
      {0.13, 0.95},
      {0.25, 1.0},
      {0.54, 0.98},
      {0.72, 0.67},
      {0.95, 0.56},
      {1.0, 0.36}}},
    {{{0.0, 0.35},
      {0.01, 0.64},
      {0.07, 0.94},
      {0.12, 0.99},
      {0.3, 1.0},
      {0.56, 0.98},
      {0.71, 0.67},
      {0.96, 0.54},
      {1.0, 0.36}}},
}};
const VehicleShape kVan{{{0.0, 0.3},
                         {0.005, 0.9},
                         {0.03, 0.98},
                         {0.1, 1.0},
                         {0.66, 1.0},
                         {0.72, 0.97},
                         {0.85, 0.6},
                         {0.98, 0.48},
                         {1.0, 0.3}},
                        0.13,
                        0.55,
                        0.9};
const VehicleShape kTruck{{{0.0, 0.25},
                           {0.0, 0.99},
                           {0.01, 1.0},
                           {0.73, 1.0},
                           {0.735, 0.84},
                           {0.76, 0.86},
                           {0.93, 0.85},
                           {0.985, 0.5},
                           {1.0, 0.2}},
                          0.14,
                          0.5,
                          0.98,
                          0.2,
                          0.86,
                          0.46};
const VehicleShape kBus{{{0.0, 0.2},
                         {0.0, 0.95},
                         {0.02, 1.0},
                         {0.5, 1.0},
                         {0.975, 1.0},
                         {0.99, 0.95},
                         {1.0, 0.45},
                         {1.0, 0.2}},
                        0.1,
                        0.45,
                        0.97,
                        0.25,
                        0.78,
                        0.48};

}  // namespace

const VehicleShape& shapeOf(ActorKind kind, int look) {
  switch (kind) {
    case ActorKind::kVan:
      return kVan;
    case ActorKind::kTruck:
      return kTruck;
    case ActorKind::kBus:
      return kBus;
    default:
      return kCars[static_cast<std::size_t>(look % 3)];
  }
}

}  // namespace headway::sim
