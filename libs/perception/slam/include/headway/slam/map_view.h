// SPDX-License-Identifier: BSD-3-Clause
// The static map and the trajectory as users see them, of a run or of a saved map.
#pragma once

#include <headway/core/ids.h>
#include <headway/core/pose.h>
#include <headway/core/shared_chunks.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace headway::slam {

/// A landmark of the static map.
struct LandmarkView {
  LandmarkId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< map frame [m]
  int observations = 0;                                ///< keyframes that observe it
  std::uint8_t intensity = 0;                          ///< grey value where it was first seen
};

/// A keyframe of the static map.
struct KeyframeView {
  KeyframeId id;
  std::size_t frame = 0;  ///< index of its stereo frame
  Time time = 0.0;        ///< [s]
  Pose T_map_robot = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Zero();
  std::vector<LandmarkId> landmarks;  ///< seen in it, ascending
};

/// The static map at one moment. Copies and later views share what did not change.
struct MapView {
  SharedChunks<LandmarkView> landmarks;  ///< ascending ids
  SharedChunks<KeyframeView> keyframes;  ///< ascending ids
};

/// Pose of one frame after all corrections of the map so far.
struct FrameEstimate {
  std::size_t frame = 0;
  Time time = 0.0;       ///< [s]
  bool tracked = false;  ///< false: lost, the pose is the last one known
  Pose T_map_robot = Pose::Identity();
};

using FrameVisitor = std::function<void(const FrameEstimate&)>;

/// Calls back for all frames of a run, in order.
using TrajectoryVisit = std::function<void(const FrameVisitor&)>;

/// The view of a map that StereoSlam::save() wrote.
///
/// @throws InputError if the bytes are cut off, damaged or of another version
[[nodiscard]] MapView savedMapView(const std::string& saved, const Pose& T_robot_cam);

/// Cuts a map of StereoSlam::save() to a box: what remains are the keyframes whose robot was in the
/// box, and of the landmarks that they see those in the box. Ids do not change.
///
/// @param box          in the map frame [m]
/// @param T_robot_cam  pose of the left camera on the robot
/// @throws InputError if the bytes are cut off, damaged or of another version
[[nodiscard]] std::string croppedMap(const std::string& saved, const Eigen::AlignedBox3d& box,
                                     const Pose& T_robot_cam);

}  // namespace headway::slam
