// SPDX-License-Identifier: BSD-3-Clause
// Rays against triangles, to check what drawings rely on without drawing.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>

namespace headway::test {

struct Ray {
  Eigen::Vector3d from, way;
};

/// How many times its way a ray goes until it meets a triangle; nullopt where it does not.
/// @see Moeller & Trumbore 1997, "Fast, minimum storage ray-triangle intersection"
inline std::optional<double> meet(const Ray& ray, const std::array<Eigen::Vector3d, 3>& corners) {
  const Eigen::Vector3d e1 = corners[1] - corners[0], e2 = corners[2] - corners[0];
  const Eigen::Vector3d p = ray.way.cross(e2);
  const double volume = e1.dot(p);
  if (std::abs(volume) < 1e-12) return std::nullopt;
  const Eigen::Vector3d to = ray.from - corners[0];
  const double u = to.dot(p) / volume;
  const double v = ray.way.dot(to.cross(e1)) / volume;
  const double t = e2.dot(to.cross(e1)) / volume;
  if (u < 0.0 || v < 0.0 || u + v > 1.0 || t <= 0.0) return std::nullopt;
  return t;
}

}  // namespace headway::test
