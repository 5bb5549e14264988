// SPDX-License-Identifier: BSD-3-Clause
#include "plain_mesh.h"

#include <vector>

namespace headway::sim {

Mesh plainMesh(const RoadNetwork& network, const Eigen::Vector2i& corner,
               const Eigen::Vector3d& anchor) {
  constexpr int kCells = 16, kPoints = 2 * kCells + 1;
  std::vector<Eigen::Vector3f> points;
  for (int x = -kCells; x <= kCells; ++x) {
    for (int y = -kCells; y <= kCells; ++y) {
      const Eigen::Vector2d xy = (corner + Eigen::Vector2i(x, y)).cast<double>() * kMeadowCell;
      const double street = network.lowestNear(xy, 26.0).value_or(anchor.z() - 1.0);
      points.push_back(
          Eigen::Vector3d(xy.x() - anchor.x(), xy.y() - anchor.y(), street - 0.35 - anchor.z())
              .cast<float>());
    }
  }
  Mesh mesh;
  for (int x = 0; x + 1 < kPoints; ++x) {
    for (int y = 0; y + 1 < kPoints; ++y) {
      const auto at = [&](int i, int k) {
        return points[static_cast<std::size_t>(i * kPoints + k)];
      };
      mesh.addQuad(at(x, y + 1), at(x + 1, y + 1), at(x + 1, y), at(x, y), UvRect{});
    }
  }
  return mesh;
}

}  // namespace headway::sim
