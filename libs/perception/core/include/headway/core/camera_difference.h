// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <optional>
#include <string>

namespace headway {

/// Both cameras in one line if images of one cannot be used with the other: size, focal lengths,
/// principal point or baseline differ by more than a calibration written with few digits does.
/// nullopt if they are the same. Their poses on the robot are not compared.
[[nodiscard]] std::optional<std::string> differenceBetween(const StereoCamera& other,
                                                           const StereoCamera& here);

}  // namespace headway
