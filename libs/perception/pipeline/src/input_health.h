// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/log.h>

#include <memory>

#include "camera_check.h"
#include "frame_state.h"
#include "mount_check.h"
#include "scale_check.h"
#include "stereo_check.h"

namespace headway::pipeline {

/// The right camera's rotation against its calibration, as it is undone in images [rad].
struct RightCamera {
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();
  bool has_moved = false;  ///< it was another one before
};

/// Says what is wrong with the input: compares each frame with the frame before, left with right
/// images, and mounting, scale, wheels, inertial sensor and clock with the motion that results.
///
///     state.findings = health.checkFrame(state);  // before it is used
///     ...
///     const auto more = health.checkResults(state);
class InputHealth {
 public:
  /// @param camera         null without images
  /// @param max_speed_mps  of the robot [m/s]
  InputHealth(std::shared_ptr<const StereoCamera> camera, double max_speed_mps);

  /// A map is loaded in which the right camera is turned like this: until it is recognised, the
  /// camera is lost.
  void resume(const Eigen::Vector3d& right_turn);

  /// Clock, motion prior and images of a frame that has no results yet.
  [[nodiscard]] Findings checkFrame(const FrameState& state);
  /// Of the newest frame.
  [[nodiscard]] slam::ImageEvidence imageEvidence() const { return images_; }
  [[nodiscard]] RightCamera rightCamera() const;

  /// What pose and detections of the frame say about the input.
  [[nodiscard]] Findings checkResults(const FrameState& state);

  /// Whether no finding so far was fatal.
  [[nodiscard]] bool isTrusted() const { return is_trusted_; }
  /// All findings that were not fatal.
  [[nodiscard]] const Warnings& warnings() const { return warnings_; }
  /// The right camera's rotation by the images so far; nullopt with too few matches.
  [[nodiscard]] std::optional<stereo::RectificationError> rectification() const {
    return stereo_check_.rectification();
  }

 private:
  void checkImages(const StereoFrame& frame, Findings& findings);
  void checkLoss(const FrameState& state, Findings& findings);
  void checkMotion(const FrameState& state, Findings& findings);
  /// Counts findings, and marks those that are the first of their name.
  [[nodiscard]] Findings counted(Findings findings);

  std::shared_ptr<const StereoCamera> camera_;
  double max_speed_mps_;
  CameraCheck camera_check_;
  StereoCheck stereo_check_;
  std::optional<MountCheck> mount_check_;  ///< with a camera, as the next one
  std::optional<ScaleCheck> scale_check_;
  slam::ImageEvidence images_ = slam::ImageEvidence::kNone;
  Eigen::Vector3d turn_ = Eigen::Vector3d::Zero();  ///< of the right camera, in the frame before
  bool was_localised_ = false;                      ///< in some frame, or in a stored map
  bool is_trusted_ = true;
  Warnings warnings_;
};

}  // namespace headway::pipeline
