// SPDX-License-Identifier: BSD-3-Clause
// Regions of an image that moving objects cover, or may cover.
#include <headway/core/box_overlap.h>
#include <headway/pipeline/moving_regions.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

namespace headway::pipeline {
namespace {

constexpr double kSameObjectIou = 0.3;
constexpr double kWiden = 0.125;      // of a box, on each side
constexpr double kFarMargin_m = 0.5;  // of the position of a box, along the ray
constexpr double kFarSigmas = 3.0;    // of the depths measured on an object
constexpr double kNear_m = 0.1;       // nearer parts of a box are not drawn

/// The confirmed track at the box's position; null if there is none.
const Track* trackOf(const Box2d& box, const std::vector<Track>& previous) {
  const Track* best = nullptr;
  double best_iou = kSameObjectIou;
  for (const auto& track : previous) {
    if (!track.box2d) continue;
    const double iou = overlap2d(box, *track.box2d);
    if (iou >= best_iou) {
      best_iou = iou;
      best = &track;
    }
  }
  return best != nullptr && best->status == TrackStatus::kConfirmed ? best : nullptr;
}

Box2d widened(const Box2d& box) {
  const double across = kWiden * (box.right - box.left);
  const double along = kWiden * (box.bottom - box.top);
  return {box.left - across, box.top - along, box.right + across, box.bottom + along};
}

/// Depth of the far side of a box, with the errors of what is measured on it [m].
double farSideOf(const Box3d& box, const StereoCamera& camera) {
  const double far_side = box.centre.z() + 0.5 * std::hypot(box.length, box.width);
  if (!(far_side > 0.0)) return std::numeric_limits<double>::infinity();
  return far_side + kFarMargin_m + kFarSigmas * stereo::rigCapability(camera).depthSigma(far_side);
}

using Corners = std::array<Eigen::Vector3d, 8>;

/// Those whose numbers differ in one binary digit are joined by an edge.
Corners cornersOf(const Box3d& box) {
  const Eigen::Vector3d front = 0.5 * box.length * frontOf(box);
  const Eigen::Vector3d side =
      0.5 * box.width * Eigen::Vector3d(front.z(), 0, -front.x()) / std::max(1e-9, front.norm());
  Corners corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    corners[i] = box.centre + (i & 1 ? front : -front) + (i & 2 ? side : -side) +
                 Eigen::Vector3d(0, (i & 4 ? 0.5 : -0.5) * box.height, 0);
  }
  return corners;
}

/// Corners in front of the near plane, and where edges pierce it.
std::vector<Eigen::Vector3d> visibleOutline(const Corners& corners) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!(corners[i].z() >= kNear_m)) continue;
    points.push_back(corners[i]);
    for (const std::size_t edge : {1, 2, 4}) {
      const Eigen::Vector3d& other = corners[i ^ edge];
      if (!(other.z() < kNear_m)) continue;
      const double ratio = (corners[i].z() - kNear_m) / (corners[i].z() - other.z());
      points.push_back(corners[i] + ratio * (other - corners[i]));
    }
  }
  return points;
}

double farSideOf(const std::optional<Box3d>& box, const StereoCamera& camera) {
  return box ? farSideOf(*box, camera) : std::numeric_limits<double>::infinity();
}

}  // namespace

MovingRegions movingRegions(const Detections& detections, const std::vector<Track>& previous,
                            const StereoCamera& camera) {
  MovingRegions regions;
  for (const auto& detection : detections.items) {
    auto box = detection.box2d;
    if (!box && detection.box3d) box = projectedBox(*detection.box3d, camera);
    if (!box || !isFinite(*box)) continue;
    const Track* track = trackOf(*box, previous);
    const MovingBox region{*box, farSideOf(detection.box3d, camera)};
    if (track != nullptr && isMoving(*track)) {
      regions.boxes.push_back(region);
    } else if (track == nullptr || track->motion_state == MotionState::kUnknown) {
      regions.unsure.push_back(region);
    }
  }
  return regions;
}

MovingRegions movingRegions(const std::vector<Detections>& sources,
                            const std::vector<Track>& previous,
                            const detect::MotionDetections& motion, Time at,
                            const StereoCamera& camera) {
  MovingRegions regions;
  for (const auto& detections : sources) {
    append(movingRegions(detections, previous, camera), regions);
  }
  append(motion.regionsAt(at, camera), regions);
  return regions;
}

void append(const MovingRegions& more, MovingRegions& all) {
  all.boxes.insert(all.boxes.end(), more.boxes.begin(), more.boxes.end());
  all.unsure.insert(all.unsure.end(), more.unsure.begin(), more.unsure.end());
  if (all.mask.empty()) {
    all.mask = more.mask;
  } else if (!more.mask.empty()) {
    cv::bitwise_or(all.mask, more.mask, all.mask);
  }
}

MovingRegions movingRegions(const std::vector<Track>& tracks, const Pose& T_map_robot,
                            const StereoCamera& camera) {
  const Pose T_cam_map = (T_map_robot * camera.T_robot_cam).inverse();
  MovingRegions regions;
  for (const auto& track : tracks) {
    if (!isMoving(track) || track.status == TrackStatus::kEnded) continue;
    const Box3d box = opticalBox(track.position, track.size, track.yaw, T_cam_map);
    const double to_m = farSideOf(box, camera);
    if (const auto around = projectedBox(box, camera)) regions.boxes.push_back({*around, to_m});
    if (track.box2d && isFinite(*track.box2d)) regions.boxes.push_back({*track.box2d, to_m});
  }
  return regions;
}

MovingRegions movableRegions(const Detections& detections, const std::vector<Track>& tracks,
                             const Pose& T_map_robot, const StereoCamera& camera) {
  const Pose T_cam_map = (T_map_robot * camera.T_robot_cam).inverse();
  MovingRegions regions;
  const auto add = [&](const std::optional<Box2d>& box, double to_m) {
    if (box && isFinite(*box)) regions.boxes.push_back({widened(*box), to_m});
  };
  for (const auto& detection : detections.items) {
    if (isVehicle(detection.object_class)) continue;
    const double to_m = farSideOf(detection.box3d, camera);
    add(detection.box2d, to_m);
    if (detection.box3d) add(projectedBox(*detection.box3d, camera), to_m);
  }
  for (const auto& track : tracks) {
    const bool stays = isVehicle(track.object_class) && track.motion_state == MotionState::kStatic;
    if (stays || track.status == TrackStatus::kEnded) continue;
    const Box3d box = opticalBox(track.position, track.size, track.yaw, T_cam_map);
    const double to_m = farSideOf(box, camera);
    add(projectedBox(box, camera), to_m);
    add(track.box2d, to_m);
  }
  return regions;
}

std::optional<Box2d> projectedBox(const Box3d& box, const StereoCamera& camera) {
  Box2d around{1e9, 1e9, -1e9, -1e9};
  for (const Eigen::Vector3d& point : visibleOutline(cornersOf(box))) {
    const auto pixel = project(point, camera);
    around.left = std::min(around.left, pixel->x());
    around.right = std::max(around.right, pixel->x());
    around.top = std::min(around.top, pixel->y());
    around.bottom = std::max(around.bottom, pixel->y());
  }
  around.left = std::max(around.left, 0.0);
  around.top = std::max(around.top, 0.0);
  around.right = std::min(around.right, camera.width - 1.0);
  around.bottom = std::min(around.bottom, camera.height - 1.0);
  if (!(around.left < around.right && around.top < around.bottom)) return std::nullopt;
  return around;
}

}  // namespace headway::pipeline
