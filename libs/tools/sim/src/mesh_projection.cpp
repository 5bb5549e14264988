// SPDX-License-Identifier: BSD-3-Clause
// Meshes in the image: their pixels, how much of it they cover, how much of them is visible.
#include "mesh_projection.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "actor_mesh.h"

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

namespace {

/// The camera of an image of at most 310 px, in which meshes are marked.
StereoCamera reduced(StereoCamera camera) {
  const double reduction = std::min(1.0, 310.0 / camera.width);
  camera.width = std::max(1, static_cast<int>(camera.width * reduction));
  camera.height = std::max(1, static_cast<int>(camera.height * reduction));
  camera.fx *= reduction;
  camera.fy *= reduction;
  camera.cx = (camera.cx + 0.5) * reduction - 0.5;
  camera.cy = (camera.cy + 0.5) * reduction - 0.5;
  return camera;
}

cv::Point fixedPoint(const Eigen::Vector3f& corner, int shift) {
  const auto scaled = [&](float value) {
    return static_cast<int>(
        std::lround(std::clamp(value, -3e4F, 3e4F) * static_cast<float>(1 << shift)));
  };
  return {scaled(corner.x()), scaled(corner.y())};
}

}  // namespace

double coveredRatio(const std::vector<Actor>& actors, const Pose& T_world_robot,
                    const StereoCamera& full) {
  constexpr int kShift = 4;  // binary digits behind the point
  const StereoCamera camera = reduced(full);
  const Eigen::Vector3d origin = T_world_robot.translation();
  Pose T_origin_cam = T_world_robot * camera.T_robot_cam;
  T_origin_cam.translation() -= origin;
  const Eigen::Isometry3f T_cam_origin = T_origin_cam.inverse().cast<float>();
  cv::Mat marks = cv::Mat::zeros(camera.height, camera.width, CV_8U);
  for (const Actor& actor : actors) {
    if ((actor.position - origin).norm() > 70.0) continue;  // covers next to nothing
    for (const auto& triangle : projectMesh(actorMesh(actor, origin), T_cam_origin, camera)) {
      cv::Point corners[3];
      for (std::size_t i = 0; i < 3; ++i) corners[i] = fixedPoint(triangle[i], kShift);
      cv::fillConvexPoly(marks, corners, 3, cv::Scalar(255), cv::LINE_8, kShift);
    }
  }
  return static_cast<double>(cv::countNonZero(marks)) / static_cast<double>(marks.total());
}

namespace {

/// Uncut box around the mesh.
Box2d boundsOf(const std::vector<ImageTriangle>& corners) {
  Box2d box{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  for (const auto& triangle : corners) {
    for (const auto& corner : triangle) {
      box.left = std::min<double>(box.left, corner.x());
      box.right = std::max<double>(box.right, corner.x());
      box.top = std::min<double>(box.top, corner.y());
      box.bottom = std::max<double>(box.bottom, corner.y());
    }
  }
  return box;
}

/// Depth may differ by this where two drawings of one surface are compared.
float tolerance(float z) { return 0.06F + 0.006F * z; }

/// Counts and marks the pixels where the mesh is what the picture shows.
void compare(const cv::Mat& mesh, const cv::Rect& area, const cv::Mat& depth, std::uint16_t label,
             cv::Mat& instances, Observation& observation) {
  int all = 0, visible = 0;
  for (int v = 0; v < area.height; ++v) {
    const auto* alone = mesh.ptr<float>(v);
    const auto* seen = depth.ptr<float>(v + area.y) + area.x;
    auto* marks = instances.ptr<std::uint16_t>(v + area.y) + area.x;
    for (int u = 0; u < area.width; ++u) {
      const bool is_mesh = alone[u] != MeshDepth::kNothing;
      const bool is_seen =
          is_mesh & (seen[u] > 0.0F) & (std::abs(seen[u] - alone[u]) <= tolerance(alone[u]));
      all += static_cast<int>(is_mesh);
      visible += static_cast<int>(is_seen);
      marks[u] = is_seen ? label : marks[u];
    }
  }
  observation.visible_pixels = visible;
  observation.visible = all > 0 ? static_cast<double>(visible) / all : 0.0;
}

/// Pixels of the image that a box reaches into.
cv::Rect pixelsOf(const Box2d& box, const cv::Size& image) {
  const cv::Point first(static_cast<int>(std::floor(std::max(box.left, -1e4))),
                        static_cast<int>(std::floor(std::max(box.top, -1e4))));
  const cv::Point last(static_cast<int>(std::ceil(std::min(box.right, 1e4))) + 1,
                       static_cast<int>(std::ceil(std::min(box.bottom, 1e4))) + 1);
  return cv::Rect(first, last) & cv::Rect({}, image);
}

}  // namespace

bool cutToImage(const Box2d& whole, const cv::Size& image, Observation& observation) {
  Box2d& box = observation.box;
  box = {std::max(whole.left, 0.0), std::max(whole.top, 0.0),
         std::min(whole.right, image.width - 1.0), std::min(whole.bottom, image.height - 1.0)};
  if (box.width() <= 0.0 || box.height() <= 0.0) return false;
  observation.truncation =
      std::clamp(1.0 - box.width() * box.height() / (whole.width() * whole.height()), 0.0, 1.0);
  return true;
}

Box3d opticalBox(const Actor& actor, const Pose& T_world_cam) {
  return headway::opticalBox(actor.centre(), actor.size, actor.yaw, T_world_cam.inverse());
}

std::vector<Observation> observeActors(const Pose& T_world_robot, const StereoCamera& camera,
                                       const std::vector<Actor>& actors,
                                       const std::vector<Mesh>& meshes, const cv::Mat& depth,
                                       cv::Mat& instances) {
  instances = cv::Mat::zeros(depth.size(), CV_16U);
  const Pose T_world_cam = T_world_robot * camera.T_robot_cam;
  Pose T_origin_cam = T_world_cam;
  T_origin_cam.translation() -= T_world_robot.translation();
  const Eigen::Isometry3f T_cam_origin = T_origin_cam.inverse().cast<float>();
  MeshDepth alone(depth.size());
  std::vector<Observation> observations;
  for (std::size_t i = 0; i < actors.size(); ++i) {
    const auto corners = projectMesh(meshes[i], T_cam_origin, camera);
    if (corners.empty()) continue;
    Observation observation;
    observation.whole = boundsOf(corners);
    const cv::Rect area = pixelsOf(observation.whole, depth.size());
    if (area.empty() || !cutToImage(observation.whole, depth.size(), observation)) continue;
    observation.actor = i;
    observation.box3d = opticalBox(actors[i], T_world_cam);
    compare(alone.draw(corners, area), area, depth, static_cast<std::uint16_t>(i + 1), instances,
            observation);
    // Something whose middle is beside or behind the camera counts if an end of it is seen.
    if (observation.box3d.centre.z() < 0.5 && observation.visible_pixels == 0) continue;
    observations.push_back(observation);
  }
  return observations;
}

}  // namespace headway::sim
