// SPDX-License-Identifier: BSD-3-Clause
// The predefined rigs: car, robot, small and rgbd.
#pragma once

#include <headway/sim/sim_params.h>

#include <string>
#include <vector>

namespace headway::sim {

/// Names of the predefined rigs: `car`, `robot`, `small`, `rgbd`.
[[nodiscard]] const std::vector<std::string>& rigNames();

/// Replaces geometry, mounting, rate and noise of the cameras by those of a predefined rig.
///
/// | rig     | baseline | image     | focal length | rate  | height | pitched down |
/// | ------- | -------- | --------- | ------------ | ----- | ------ | ------------ |
/// | `car`   | 0.54 m   | 1240x376  | 718 px       | 10 Hz | 1.65 m | 0 deg        |
/// | `robot` | 0.12 m   | 1280x720  | 700 px       | 15 Hz | 0.5 m  | 10 deg       |
/// | `small` | 0.05 m   | 640x480   | 450 px       | 15 Hz | 0.3 m  | 5 deg        |
/// | `rgbd`  | -        | 848x480   | 425 px       | 15 Hz | 0.5 m  | 10 deg       |
///
/// `rgbd` is a depth camera of 0.4 to 8 m, whose projector is 0.075 m beside it.
///
/// What does not belong to the rig (lens distortion, blur, lost frames, which sensors are recorded)
/// stays as it is.
///
/// @throws InputError listing the names if there is no such rig
void applyRig(const std::string& name, CameraParams& camera);

}  // namespace headway::sim
