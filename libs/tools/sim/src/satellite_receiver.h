// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>
#include <headway/geo/geodetic_frame.h>
#include <headway/sim/simulator.h>

#include <optional>
#include <vector>

namespace headway::sim {

/// A satellite receiver on the robot, with independent errors.
class SatelliteReceiver {
 public:
  SatelliteReceiver(const GnssParams& params, std::uint64_t seed);

  /// The robot's pose at the end of each step of the motion; takes a fix if one is due.
  void observe(Time time, const Pose& T_world_robot);
  /// Fixes since last taken.
  [[nodiscard]] std::vector<io::RecordedGnss> take();
  /// Where the robot is and where it looks.
  [[nodiscard]] TruePlace placeOf(Time time, const Pose& T_world_robot) const;

 private:
  GnssParams params_;
  Random random_;
  geo::GeodeticFrame frame_;  ///< at the world's origin
  Pose T_enu_world_ = Pose::Identity();
  std::optional<Time> due_;
  std::vector<io::RecordedGnss> fixes_;
};

}  // namespace headway::sim
