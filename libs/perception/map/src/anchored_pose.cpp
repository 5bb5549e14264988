// SPDX-License-Identifier: BSD-3-Clause
// Poses of scans that follow the nearest keyframe when the map is corrected.
#include <headway/map/anchored_pose.h>
#include <mrpt/core/exceptions.h>

#include <cmath>
#include <limits>

#include "stored_values.h"

namespace headway::map {
namespace {

constexpr double kHeadingStep = M_PI / 12.0;  ///< between directions whose scans are kept [rad]

}  // namespace

ScanPlace scanPlace(const Pose& T_map_robot, double spacing_m) {
  ASSERT_GT_(spacing_m, 0.0);
  const auto step = [](double value, double size) {
    return static_cast<std::int32_t>(std::floor(value / size));
  };
  const Eigen::Vector3d& at = T_map_robot.translation();
  return {step(at.x(), spacing_m), step(at.y(), spacing_m), step(yawOf(T_map_robot), kHeadingStep)};
}

void write(ByteWriter& out, const AnchoredPose& pose) {
  write(out, pose.T_map_robot);
  out.value(pose.anchor.value);
  write(out, pose.T_anchor_robot);
}

AnchoredPose readAnchoredPose(ByteReader& in) {
  AnchoredPose pose;
  pose.T_map_robot = readPose(in);
  pose.anchor.value = in.value<std::int64_t>();
  pose.T_anchor_robot = readPose(in);
  if (!isRigid(pose.T_map_robot, kMaxMapCoordinate_m) ||
      !isRigid(pose.T_anchor_robot, kMaxMapCoordinate_m)) {
    throw InputError("damaged: one has no pose");
  }
  return pose;
}

void AnchorPoses::update(const SharedChunks<slam::KeyframeView>& keyframes) {
  poses_.clear();
  for (const auto& keyframe : keyframes) poses_[keyframe.id] = keyframe.T_map_robot;
}

void AnchorPoses::attach(AnchoredPose& pose) const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [id, T_map_keyframe] : poses_) {
    const double distance =
        (T_map_keyframe.translation() - pose.T_map_robot.translation()).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    pose.anchor = id;
    pose.T_anchor_robot = T_map_keyframe.inverse() * pose.T_map_robot;
  }
}

std::optional<Pose> AnchorPoses::movedPose(AnchoredPose& pose, double min_m, double min_rad) const {
  const auto anchor = poses_.find(pose.anchor);
  if (anchor == poses_.end()) {
    attach(pose);
    return std::nullopt;
  }
  const Pose moved = anchor->second * pose.T_anchor_robot;
  const Pose& before = pose.T_map_robot;
  if ((moved.translation() - before.translation()).norm() <= min_m &&
      Eigen::AngleAxisd(before.linear().transpose() * moved.linear()).angle() <= min_rad) {
    return std::nullopt;
  }
  return moved;
}

}  // namespace headway::map
