// SPDX-License-Identifier: BSD-3-Clause
#include "consensus.h"

#include <algorithm>
#include <opencv2/calib3d.hpp>

namespace headway::slam {

std::optional<Consensus> poseByConsensus(const std::vector<stereo::PoseConstraint>& constraints,
                                         const StereoCamera& camera, int min_inliers,
                                         double max_error_px, int max_tries) {
  constexpr double kConfidence = 0.999;
  if (static_cast<int>(constraints.size()) < std::max(6, min_inliers)) return std::nullopt;
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  for (const stereo::PoseConstraint& constraint : constraints) {
    const Eigen::Vector3d& p = constraint.point_map;
    points.emplace_back(p.x(), p.y(), p.z());
    pixels.emplace_back(constraint.measurement.uv.x(), constraint.measurement.uv.y());
  }
  const cv::Matx33d intrinsics(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1);
  cv::Vec3d rotation, translation;
  std::vector<int> inliers;
  const bool found = cv::solvePnPRansac(
      points, pixels, intrinsics, cv::noArray(), rotation, translation, false, max_tries,
      static_cast<float>(max_error_px), kConfidence, inliers, cv::SOLVEPNP_P3P);
  if (!found || static_cast<int>(inliers.size()) < min_inliers) return std::nullopt;
  Pose T_cam_map = Pose::Identity();
  T_cam_map.linear() = expSo3({rotation[0], rotation[1], rotation[2]});
  T_cam_map.translation() << translation[0], translation[1], translation[2];
  if (!T_cam_map.matrix().allFinite()) return std::nullopt;
  return Consensus{T_cam_map.inverse(Eigen::Isometry), static_cast<int>(inliers.size())};
}

}  // namespace headway::slam
