// SPDX-License-Identifier: BSD-3-Clause
// All streets of a world and where they meet.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "route.h"

namespace headway::sim {

/// One street: its middle line, and where along it there is something to draw.
struct Road {
  Path axis;
  std::vector<bool> drawn;  ///< for each metre; false where it repeats an earlier stretch
  bool main = true;         ///< the robot's street; else a cross street
  double junction_s = 0.0;  ///< of a cross street: where it meets the main street, on its own axis
  double main_s = 0.0;      ///< and on the main street's
};

/// All streets of a world, and which of them a place on the ground belongs to.
///
/// Where the robot's path passes a place again, its street is there already and is not laid
/// twice, so the place looks the same.
class RoadNetwork {
 public:
  RoadNetwork(const Route& route, double cross_street_every_m, std::uint64_t seed);

  [[nodiscard]] const std::vector<Road>& roads() const { return roads_; }

  struct Place {
    std::size_t road = 0;
    double s = 0.0;
    double left = 0.0;    ///< [m]
    double height = 0.0;  ///< of the street's middle there [m]
  };
  /// Nearest street within `reach` metres of its middle.
  [[nodiscard]] std::optional<Place> nearest(const Eigen::Vector2d& xy, double reach) const;
  /// Whether a street other than this stretch of `road` has its middle within `reach` metres.
  ///
  /// @param earlier_only  look at streets that were laid before it alone
  [[nodiscard]] bool nearOther(const Eigen::Vector2d& xy, double reach, std::size_t road, double s,
                               bool earlier_only) const;
  /// Cross streets whose junction is within `reach` metres of a place on the robot's street, in the
  /// order in which they were laid.
  ///
  /// @param main_s  along the robot's street, in any lap [m]
  [[nodiscard]] std::vector<const Road*> crossStreetsNear(double main_s, double reach) const;
  /// Lowest street middle within `reach` metres; nullopt if there is none.
  [[nodiscard]] std::optional<double> lowestNear(const Eigen::Vector2d& xy, double reach) const;

 private:
  struct Sample {
    std::size_t road;
    double s;
    Eigen::Vector2d xy;
    double height;
  };

  void layMain(const Route& route);
  void layCrossStreets(const Route& route, double every, std::uint64_t seed);
  void addSamples(std::size_t road, double from, double to);
  [[nodiscard]] std::pair<int, int> cellOf(const Eigen::Vector2d& xy) const;
  /// The samples of all cells within reach of a place; some of them lie farther off.
  [[nodiscard]] std::vector<const Sample*> samplesAround(const Eigen::Vector2d& xy,
                                                         double reach) const;

  std::vector<Road> roads_;
  std::map<std::pair<int, int>, std::vector<Sample>> cells_;
};

}  // namespace headway::sim
