// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/pipeline/perception_update.h>
#include <headway/stereo/frame_context.h>

namespace headway::pipeline {

/// Recognises a wrong pose of the camera on the robot from the first images.
///
/// The ground decides: it is searched as the camera is said to be mounted. Found once, at the
/// mounted height, it confirms the mounting, and nothing more is computed. Otherwise it is searched
/// as it would appear if the pose lacked the optical turn (x right, y down, z forward), or if the
/// camera were upside-down. Where the mounted height is known, planes at another height, such as a
/// ceiling, are not taken for the ground. Where no ground is seen, as from a drone, the gyroscope's
/// turns tell a missing optical turn: it permutes the axes of the camera's turns.
class MountCheck {
 public:
  explicit MountCheck(const StereoCamera& camera) : camera_(camera) {}

  /// Takes the ground and the disparities of one frame.
  ///
  /// @return fatal: "camera_pose", with the error and the pose to write, once
  [[nodiscard]] std::optional<Finding> addImage(const stereo::FrameContext& context);

  /// Takes the robot's turn since the previous frame, in the robot frame. Ignored once the ground
  /// confirmed the mounting.
  ///
  /// @return as addImage()
  [[nodiscard]] std::optional<Finding> addTurn(const Eigen::Matrix3d& by_camera,
                                               const Eigen::Matrix3d& by_gyroscope,
                                               std::size_t frame);

 private:
  [[nodiscard]] bool showsGround(const stereo::DisparityImage& disparity,
                                 const StereoCamera& camera) const;
  [[nodiscard]] bool isAtMountedHeight(const stereo::GroundPlane& ground) const;
  /// What is wrong, as text; empty unless it is certain.
  [[nodiscard]] std::string testOpticalTurn(const stereo::DisparityImage& disparity);
  [[nodiscard]] std::string testUpsideDown(const stereo::DisparityImage& disparity);
  [[nodiscard]] std::string textWithoutTurn(const std::string& evidence) const;
  [[nodiscard]] std::optional<Finding> decide(const std::string& text, std::size_t frame);

  StereoCamera camera_;
  bool decided_ = false;
  bool decided_by_turns_ = false;
  int images_ = 0;                      ///< in which the ground was not found
  int without_turn_ = 0;                ///< with ground if the pose lacks the optical turn
  int upside_down_ = 0;                 ///< with ground if the camera is upside-down
  double turned_rad_ = 0.0;             ///< by the gyroscope; sum of the angles
  double difference_rad_ = 0.0;         ///< of the camera's turns from it, by the pose as written
  double difference_turned_rad_ = 0.0;  ///< by the pose with the optical turn
};

}  // namespace headway::pipeline
