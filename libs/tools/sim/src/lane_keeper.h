// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <utility>

#include "driving.h"
#include "route.h"

namespace headway::sim {

/// A vehicle that never leaves one lane of the route's street.
///
/// Its place is kept along the street's middle, where the lanes of both sides can be compared.
class LaneKeeper {
 public:
  /// @param left  of the lane from the street's middle [m]
  /// The route must outlive the object.
  LaneKeeper(const Route& route, double left);

  double s = 0.0;      ///< along the street [m]
  double speed = 0.0;  ///< [m/s]
  double length = 4.5;
  double width = 1.8;

  /// What a driver of that style does behind and around the others.
  [[nodiscard]] double acceleration(const DriverStyle& style, const std::vector<Obstacle>& others,
                                    std::int64_t own_id);
  /// One step of time; never backwards.
  void move(double dt, double acceleration);
  [[nodiscard]] PathPoint place() const;

 private:
  [[nodiscard]] double alongLane();

  const Route& route_;
  double left_;
  Path lane_;
  /// The place found last: along the street and along the lane, which differ in curves [m].
  std::optional<std::pair<double, double>> found_;
};

}  // namespace headway::sim
