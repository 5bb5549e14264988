// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>

#include <opencv2/core/mat.hpp>

#include "actor.h"

namespace headway::sim {

// Layout of one vehicle's cell in the atlas [px]: x of the side and the top picture runs from the
// rear to the front of the vehicle.
inline constexpr int kVehicleCellWidth = 512;
inline constexpr int kVehicleCellHeight = 256;
inline const cv::Rect kVehicleSide{0, 0, 320, 128};
inline const cv::Rect kVehicleTop{0, 128, 320, 128};
inline const cv::Rect kVehicleFront{320, 0, 160, 128};
inline const cv::Rect kVehicleRear{320, 128, 160, 128};
inline const cv::Rect kVehicleDark{480, 0, 32, 256};

/// Paints body, windows, lights, doors and wheels of one vehicle into its cell.
void paintVehicle(cv::Mat cell, ActorKind kind, Random& random);

}  // namespace headway::sim
