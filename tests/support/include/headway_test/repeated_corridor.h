// SPDX-License-Identifier: BSD-3-Clause
// A corridor of which each part comes again.
#pragma once

#include <headway_test/textured_world.h>

namespace headway::test {

inline constexpr double kCorridorRepeat_m = 10.24;  ///< of the texture

/// 60 m along x, from -5 m on, 3 m wide and high: in its map, only who is told knows where it is.
inline TexturedWorld repeatedCorridor() {
  TexturedWorld corridor(smallCamera());
  using V = Eigen::Vector3d;
  const V low(-5.0, -1.5, -1.5), x = V::UnitX(), y = V::UnitY(), z = V::UnitZ();
  for (const double side : {0.0, 3.0}) {
    corridor.boards.push_back({low + side * z, x, y, 60.0, 3.0, {side, 1.7}});
    corridor.boards.push_back({low + side * y, x, z, 60.0, 3.0, {5.3, side}});
  }
  return corridor;
}

}  // namespace headway::test
