// SPDX-License-Identifier: BSD-3-Clause
// Textured triangles.
#include "mesh.h"

#include <utility>

namespace headway::sim {

void Mesh::addQuad(const Eigen::Vector3f& top_left, const Eigen::Vector3f& top_right,
                   const Eigen::Vector3f& bottom_right, const Eigen::Vector3f& bottom_left,
                   const UvRect& uv) {
  const MeshVertex a{top_left, uv.at(0, 0)}, b{top_right, uv.at(1, 0)};
  const MeshVertex c{bottom_right, uv.at(1, 1)}, d{bottom_left, uv.at(0, 1)};
  addTriangle(a, b, c);
  addTriangle(a, c, d);
}

void Mesh::append(const Mesh& other) {
  triangles.insert(triangles.end(), other.triangles.begin(), other.triangles.end());
}

std::vector<Eigen::Vector3f> cornersOf(const std::array<MeshVertex, 3>& triangle) {
  return {triangle[0].position, triangle[1].position, triangle[2].position};
}

std::vector<Eigen::Vector3f> boxCorners(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& triangle : mesh.triangles) {
    for (const auto& vertex : triangle) box.extend(vertex.position);
  }
  std::vector<Eigen::Vector3f> corners;
  for (int i = 0; i < 8 && !box.isEmpty(); ++i) {
    corners.push_back(box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)));
  }
  return corners;
}

Mesh turnedOver(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

Mesh moved(Mesh mesh, const Eigen::Matrix3f& rotation, const Eigen::Vector3f& translation) {
  for (auto& triangle : mesh.triangles) {
    for (auto& vertex : triangle) {
      vertex.position = (rotation * vertex.position + translation).eval();
    }
  }
  return mesh;
}

}  // namespace headway::sim
