// SPDX-License-Identifier: BSD-3-Clause
// The frames that a rig takes of an environment.
#pragma once

#include <headway/sim/sim_params.h>

#include <functional>
#include <optional>
#include <vector>

#include "environment.h"
#include "frame_finisher.h"
#include "lens.h"
#include "stereo_rig.h"

namespace headway::sim {

/// Draws what the robot's rig sees of its environment where both are now, and finishes it.
///
/// Frames are drawn in one thread, one after another; finish() may be called in another one while
/// the next frame is drawn.
class FrameDrawer {
 public:
  /// Lets so many seconds pass in the environment, none included; returns the time then.
  using PassTime = std::function<Time(double)>;

  explicit FrameDrawer(const SimParams& params);

  /// The scene is made with the first frame, all of which are of the same environment.
  ///
  /// @param trigger  number of the frame among all that were taken, from 1
  /// @param pass     between the drawings of one exposure, if there is motion blur
  [[nodiscard]] DrawnFrame draw(Environment& environment, std::size_t trigger,
                                const PassTime& pass);
  [[nodiscard]] SimFrame finish(DrawnFrame drawn) { return finisher_.finish(std::move(drawn)); }

  [[nodiscard]] const Lens& lens() const { return lens_; }
  /// Between the drawings of one exposure; 0 without motion blur [s].
  [[nodiscard]] double blurPause() const;

 private:
  /// With the parked ones.
  [[nodiscard]] std::vector<Actor> actorsInView(Environment& environment) const;
  /// The right camera in the left one, for one frame.
  [[nodiscard]] Pose bentRig(std::size_t frame) const;

  SimParams params_;
  Lens lens_;
  std::optional<StereoRig> rig_;
  FrameFinisher finisher_;
};

}  // namespace headway::sim
