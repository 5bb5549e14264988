// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "site_builder.h"

namespace headway::sim {

/// A kerb along x between a pavement at height 0 and a roadway below it, lowered to ramps.
///
/// A ramp is 1.8 m wide and 1.25 m long; its flared sides take 0.35 m more on either side.
struct Kerb {
  static constexpr double kHalfRamp = 0.9, kFlare = 0.35, kRun = 1.25;  // [m]

  double y = 0.0;         ///< edge of the roadway [m]
  double pavement = 1.0;  ///< +1 if the pavement lies towards +y, -1 if towards -y
  double height_m = 0.1;  ///< pavement above the roadway; with kRun an 8 % slope
  double from_x = 0.0, to_x = 10.0;
  std::vector<double> ramps;  ///< their middles, x, ascending [m]

  /// Ground that the ramps take from the pavement.
  [[nodiscard]] std::vector<Eigen::AlignedBox2d> rampAreas() const;
};

/// Lays stones and ramps; the kerb is impassable but for the ramps.
void addKerb(SiteBuilder& builder, const Kerb& kerb);

}  // namespace headway::sim
