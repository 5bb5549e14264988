#pragma once

#include <headway/core/ids.h>
#include <headway/core/pose.h>

#include <cstdint>
#include <vector>

namespace headway::slam {

/// A landmark as others see it.
struct LandmarkView {
  LandmarkId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< map frame [m]
  int observations = 0;                                ///< keyframes that see it
  std::uint8_t intensity = 0;                          ///< grey value where it was first seen
};

/// A keyframe as others see it.
struct KeyframeView {
  KeyframeId id;
  std::size_t frame = 0;  ///< index of its stereo frame
  Time time = 0.0;        ///< [s]
  Pose T_map_robot = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Zero();
  std::vector<LandmarkId> landmarks;  ///< seen in it, ascending
};

/// The still world at one moment: a copy, safe to keep.
struct MapView {
  std::vector<LandmarkView> landmarks;  ///< ascending ids
  std::vector<KeyframeView> keyframes;  ///< ascending ids
};

/// What became of one frame after all corrections of the map so far.
struct FrameEstimate {
  std::size_t frame = 0;
  Time time = 0.0;       ///< [s]
  bool tracked = false;  ///< false: lost, the pose is the last one known
  Pose T_map_robot = Pose::Identity();
};

}  // namespace headway::slam
