// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <vector>

#include "motion_frame.h"
#include "moving_object.h"

namespace headway::detect {

/// Joins the pieces of one vehicle, which are found apart where few points of it can be followed.
///
/// Pieces touch, move with the same velocity within its uncertainty and faster than people walk,
/// one of them is a vehicle by itself, and together they are no larger than vehicles may be.
///
/// @param objects  of this frame; those without evidence of motion are left as they are
void joinPieces(const MotionFrame& frame, const StereoCamera& camera,
                std::vector<MovingObject>& objects);

}  // namespace headway::detect
