// SPDX-License-Identifier: BSD-3-Clause
// Furniture of halls, campuses and warehouses.
#pragma once

#include <headway/core/random.h>

#include "site.h"

namespace headway::sim {

// All stand on the floor with their middle at `at`; x is where they, or who uses them, face.

/// Desk with screen, keyboard, drawers and chair; somebody may sit there.
void addDesk(SiteBuilder& builder, const Spot& at, Random& random);
/// Office chair; a seat.
void addChair(SiteBuilder& builder, const Spot& at, Random& random);
/// Table with chairs along both long sides.
void addMeetingTable(SiteBuilder& builder, const Spot& at, int chairs_a_side, Random& random);
void addSofa(SiteBuilder& builder, const Spot& at);
/// Bookcase or cupboard, 1.6 to 2.1 m high.
void addCupboard(SiteBuilder& builder, const Spot& at, Random& random);
/// Pot with leaves.
void addPlant(SiteBuilder& builder, const Eigen::Vector2d& at, Random& random);
/// Poster or notice on a wall; `at` is on the wall's face and faces away from it.
void addNotice(SiteBuilder& builder, const Spot& at, Random& random);
/// Double socket low on a wall and a switch above it; placed as a notice.
void addSocket(SiteBuilder& builder, const Spot& at);
/// Radiator before a wall.
void addRadiator(SiteBuilder& builder, const Spot& at);
/// Bench with a back; two seats.
void addBench(SiteBuilder& builder, const Spot& at);
/// Stands with parked bicycles side by side along x.
void addBicycleStand(SiteBuilder& builder, const Spot& at, int bicycles, Random& random);
/// Pallet with cartons.
///
/// @param base_m  height of what it stands on
void addPallet(SiteBuilder& builder, const Spot& at, double base_m, Random& random);
/// Size of a bay of a pallet rack [m].
struct RackBay {
  double length = 2.7, depth = 1.1, height = 4.4;
};
inline constexpr RackBay kRackBay{};
/// Bay of a pallet rack, its length along x, with loads on three levels.
void addRackBay(SiteBuilder& builder, const Spot& at, Random& random);

/// A machine or a piece of furniture of a random shape, 0.7 to 2.1 m high: stacked boxes, a post
/// with a head, a frame with shelves, or clothes on a stand.
void addMachine(SiteBuilder& builder, const Spot& at, Random& random);
/// Machines at random places beside what stands on the floor, clear of all that people and the
/// robot go to.
void addMachines(SiteBuilder& builder, int count, Random& random);

}  // namespace headway::sim
