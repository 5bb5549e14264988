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

Mesh turnedOver(Mesh mesh) {
  for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  return mesh;
}

Mesh moved(const Mesh& mesh, const Eigen::Matrix3f& rotation, const Eigen::Vector3f& translation) {
  Mesh result = mesh;
  for (auto& triangle : result.triangles) {
    for (auto& vertex : triangle) {
      vertex.position = (rotation * vertex.position + translation).eval();
    }
  }
  return result;
}

}  // namespace headway::sim
