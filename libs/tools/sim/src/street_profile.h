// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace headway::sim {

/// Cross-section of every street, from its middle outwards [m].
///
/// Two lanes, a strip for cyclists beside each, parking along the kerbs, raised pavements.
struct StreetProfile {
  static constexpr double kLane = 3.3;         ///< width of a lane
  static constexpr double kCarriageway = 6.4;  ///< middle to kerb: lane, cycling, parking
  static constexpr double kKerbHeight = 0.12;
  static constexpr double kPavement = 2.8;                   ///< width of a pavement
  static constexpr double kEdge = kCarriageway + kPavement;  ///< middle to outer pavement edge

  static constexpr double kLaneMiddle = kLane / 2.0;  ///< middle of street to middle of lane
  static constexpr double kCycling = 3.85;            ///< middle of street to a cyclist
  static constexpr double kParking = 5.35;            ///< middle of street to a parked car
};

}  // namespace headway::sim
