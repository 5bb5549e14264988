// SPDX-License-Identifier: BSD-3-Clause
#include "mesh_projection.h"

#include <algorithm>
#include <cmath>

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
      const float ratio = (kNearPlane - from.z()) / (to.z() - from.z());
      points_[count_++] = from + ratio * (to - from);
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

const cv::Mat& MeshDepth::draw(const std::vector<ImageTriangle>& mesh, const cv::Rect& area) {
  picture_ = buffer_(cv::Rect({}, area.size()));
  picture_.setTo(kNothing);
  for (const ImageTriangle& triangle : mesh) drawTriangle(triangle, area);
  return picture_;
}

void MeshDepth::drawTriangle(const ImageTriangle& corners, const cv::Rect& area) {
  const Eigen::Vector3f a = corners[0], b = corners[1], c = corners[2];
  const float twice_area = (b.x() - a.x()) * (c.y() - a.y()) - (c.x() - a.x()) * (b.y() - a.y());
  if (std::abs(twice_area) < 1e-6F) return;
  const auto low = [](float x, float y, float z) {
    return static_cast<int>(std::ceil(std::max(-1e6F, std::min({x, y, z}))));
  };
  const auto high = [](float x, float y, float z) {
    return static_cast<int>(std::floor(std::min(1e6F, std::max({x, y, z}))));
  };
  const int u0 = std::max(low(a.x(), b.x(), c.x()), area.x);
  const int u1 = std::min(high(a.x(), b.x(), c.x()), area.x + area.width - 1);
  const int v0 = std::max(low(a.y(), b.y(), c.y()), area.y);
  const int v1 = std::min(high(a.y(), b.y(), c.y()), area.y + area.height - 1);
  for (int v = v0; v <= v1; ++v) {
    auto* row = picture_.ptr<float>(v - area.y);
    const float y = static_cast<float>(v) - a.y();
    const float b_along = c.y() - a.y(), b_across = (c.x() - a.x()) * y;
    const float c_along = b.y() - a.y(), c_across = (b.x() - a.x()) * y;
    // Without branches, so that the compiler takes several pixels at a time.
    for (int u = u0; u <= u1; ++u) {
      const float x = static_cast<float>(u) - a.x();
      const float wb = (x * b_along - b_across) / twice_area;
      const float wc = (c_across - x * c_along) / twice_area;
      const float wa = 1.0F - wb - wc;
      const float z = 1.0F / (wa * a.z() + wb * b.z() + wc * c.z());
      const bool nearer = (wa >= 0.0F) & (wb >= 0.0F) & (wc >= 0.0F) & (z < row[u - area.x]);
      row[u - area.x] = nearer ? z : row[u - area.x];
    }
  }
}

}  // namespace headway::sim
