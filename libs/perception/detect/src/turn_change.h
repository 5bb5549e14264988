// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/stereo/frame_context.h>

#include <Eigen/Core>
#include <vector>

#include "point_motion.h"

namespace headway::detect {

/// Converts observations of earlier frames to disparities as they are measured in the newest one.
///
/// In right images that are turned back by different rotations static points would seem to move.
class TurnChange {
 public:
  explicit TurnChange(const StereoCamera& camera) : camera_(camera) {}

  /// Takes over what is undone in a new frame.
  ///
  /// @return  whether it differs from the frame before, so that observations are to be converted
  bool advance(const stereo::FrameContext& context);

  /// Observations whose disparity becomes less than 1 px are removed.
  void apply(std::vector<Observation>& observations) const;

 private:
  struct Undone {
    Eigen::Vector3d angles = Eigen::Vector3d::Zero();  ///< as FrameContext::rightTurn() [rad]
    double offset_px = 0.0;                            ///< as FrameContext::disparityOffset()
  };
  StereoCamera camera_;
  Undone before_, now_;
};

}  // namespace headway::detect
