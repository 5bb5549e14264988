#include "mesh_projection.h"

namespace headway::sim {
namespace {

/// A triangle cut by the near plane: three or four corners are left, or none.
/// @see Sutherland & Hodgman 1974, "Reentrant polygon clipping"
class CutTriangle {
 public:
  explicit CutTriangle(const std::array<Eigen::Vector3f, 3>& corners) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3f &from = corners[i], &to = corners[(i + 1) % 3];
      if (from.z() >= kNearPlane) points_[count_++] = from;
      if ((from.z() >= kNearPlane) == (to.z() >= kNearPlane)) continue;
      const float share = (kNearPlane - from.z()) / (to.z() - from.z());
      points_[count_++] = from + share * (to - from);
    }
  }
  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] const Eigen::Vector3f& operator[](std::size_t i) const { return points_[i]; }

 private:
  std::array<Eigen::Vector3f, 4> points_;
  std::size_t count_ = 0;
};

}  // namespace

std::vector<ImageTriangle> projectMesh(const Mesh& mesh, const Eigen::Isometry3f& T_cam_mesh,
                                       const StereoCamera& camera) {
  const auto project = [&](const Eigen::Vector3f& p) {
    return Eigen::Vector3f(
        static_cast<float>(camera.fx) * p.x() / p.z() + static_cast<float>(camera.cx),
        static_cast<float>(camera.fy) * p.y() / p.z() + static_cast<float>(camera.cy),
        1.0F / p.z());
  };
  std::vector<ImageTriangle> result;
  result.reserve(mesh.triangles.size());
  for (const auto& triangle : mesh.triangles) {
    const CutTriangle cut({T_cam_mesh * triangle[0].position, T_cam_mesh * triangle[1].position,
                           T_cam_mesh * triangle[2].position});
    for (std::size_t i = 2; i < cut.size(); ++i) {
      result.push_back({project(cut[0]), project(cut[i - 1]), project(cut[i])});
    }
  }
  return result;
}

}  // namespace headway::sim
