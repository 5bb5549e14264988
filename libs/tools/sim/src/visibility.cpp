// SPDX-License-Identifier: BSD-3-Clause
#include "visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "mesh_projection.h"

namespace headway::sim {
namespace {

/// Uncut box around the mesh.
Box2d boundsOf(const std::vector<ImageTriangle>& corners) {
  constexpr double kInf = std::numeric_limits<double>::infinity();
  Box2d box{kInf, kInf, -kInf, -kInf};
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

/// An observation with its boxes alone; nullopt if the box lies outside the image.
std::optional<Observation> boxedObservation(const Box2d& whole, const cv::Size& image) {
  Observation observation;
  observation.whole = whole;
  observation.box = {std::max(whole.left, 0.0), std::max(whole.top, 0.0),
                     std::min(whole.right, image.width - 1.0),
                     std::min(whole.bottom, image.height - 1.0)};
  const Box2d& box = observation.box;
  if (box.width() <= 0.0 || box.height() <= 0.0) return std::nullopt;
  observation.truncation =
      std::clamp(1.0 - box.width() * box.height() / (whole.width() * whole.height()), 0.0, 1.0);
  return observation;
}

}  // namespace

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
    const Box2d whole = boundsOf(corners);
    const cv::Rect area = pixelsOf(whole, depth.size());
    auto observation = boxedObservation(whole, depth.size());
    if (area.empty() || !observation) continue;
    observation->actor = i;
    observation->box3d = opticalBox(actors[i], T_world_cam);
    compare(alone.draw(corners, area), area, depth, static_cast<std::uint16_t>(i + 1), instances,
            *observation);
    // Something whose middle is beside or behind the camera counts if an end of it is seen.
    if (observation->box3d.centre.z() < 0.5 && observation->visible_pixels == 0) continue;
    observations.push_back(*observation);
  }
  return observations;
}

}  // namespace headway::sim
