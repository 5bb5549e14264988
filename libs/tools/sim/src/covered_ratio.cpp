// SPDX-License-Identifier: BSD-3-Clause
#include "covered_ratio.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "actor_mesh.h"
#include "mesh_projection.h"

namespace headway::sim {
namespace {

constexpr double kMarkedWidth = 310.0;  // of the image in which the meshes are marked, or less [px]
constexpr double kFarthest = 70.0;      // what is farther covers next to nothing [m]

StereoCamera reduced(StereoCamera camera) {
  const double reduction = std::min(1.0, kMarkedWidth / camera.width);
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
    if ((actor.position - origin).norm() > kFarthest) continue;
    for (const auto& triangle : projectMesh(actorMesh(actor, origin), T_cam_origin, camera)) {
      cv::Point corners[3];
      for (std::size_t i = 0; i < 3; ++i) corners[i] = fixedPoint(triangle[i], kShift);
      cv::fillConvexPoly(marks, corners, 3, cv::Scalar(255), cv::LINE_8, kShift);
    }
  }
  return static_cast<double>(cv::countNonZero(marks)) / static_cast<double>(marks.total());
}

}  // namespace headway::sim
