// SPDX-License-Identifier: BSD-3-Clause
// Textured triangles.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace headway::sim {

/// A rectangle of a texture, in ratios of its width and height (v grows downwards).
struct UvRect {
  float u0 = 0.0F, v0 = 0.0F, u1 = 1.0F, v1 = 1.0F;

  /// Point of the rectangle at the ratios (x, y) of its own width and height.
  [[nodiscard]] Eigen::Vector2f at(float x, float y) const {
    return {u0 + (u1 - u0) * x, v0 + (v1 - v0) * y};
  }
  [[nodiscard]] UvRect part(float x0, float y0, float x1, float y1) const {
    const Eigen::Vector2f a = at(x0, y0), b = at(x1, y1);
    return {a.x(), a.y(), b.x(), b.y()};
  }
};

struct MeshVertex {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< [m]
  Eigen::Vector2f uv = Eigen::Vector2f::Zero();        ///< texture ratios, v downwards
};

/// Textured triangles: three vertices each, clockwise where one looks at the front.
///
/// Of closed meshes (houses, furniture) only fronts are drawn; of actors, whose limbs are open, and
/// of the ground, whose kerbs end, both faces are.
struct Mesh {
  std::vector<std::array<MeshVertex, 3>> triangles;

  void addTriangle(const MeshVertex& a, const MeshVertex& b, const MeshVertex& c) {
    triangles.push_back({a, b, c});
  }
  /// Corners in turn: top left, top right, bottom right, bottom left of the texture rectangle.
  void addQuad(const Eigen::Vector3f& top_left, const Eigen::Vector3f& top_right,
               const Eigen::Vector3f& bottom_right, const Eigen::Vector3f& bottom_left,
               const UvRect& uv);
  void append(const Mesh& other);
};

/// The corners of the upright box around a mesh, or of one triangle.
[[nodiscard]] std::vector<Eigen::Vector3f> boxCorners(const Mesh& mesh);
[[nodiscard]] std::vector<Eigen::Vector3f> cornersOf(const std::array<MeshVertex, 3>& triangle);

/// The same triangles, fronts and backs exchanged.
[[nodiscard]] Mesh turnedOver(Mesh mesh);

/// Moves and turns every vertex: p -> R p + t.
[[nodiscard]] Mesh moved(Mesh mesh, const Eigen::Matrix3f& rotation,
                         const Eigen::Vector3f& translation);

}  // namespace headway::sim
