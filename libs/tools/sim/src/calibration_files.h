// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <string>

namespace headway::sim {

/// KITTI's calib.txt: P0 ... P3 (pairs 0/1 and 2/3 are the same), R0_rect, and the robot frame in
/// the place of the lidar's. @throws InputError if it cannot be written
void writeKittiCalibration(const std::string& path, const StereoCamera& camera);

}  // namespace headway::sim
