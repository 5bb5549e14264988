// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>

#include <Eigen/Core>
#include <optional>

namespace headway::objects {

/// Predicts the image box of an object that moved relative to the camera.
///
/// Needs no calibration: the focal length follows from the heights of the object and of its box,
/// shift and scale from the pinhole model.
///
/// @param box     of the object at `from` [px]
/// @param from    centre in the sensor's optical frame [m]
/// @param to      centre now, same frame [m]
/// @param height  of the object [m]
/// @return        nullopt if the object is not in front of the camera
[[nodiscard]] std::optional<Box2d> predictedBox(const Box2d& box, const Eigen::Vector3d& from,
                                                const Eigen::Vector3d& to, double height);

}  // namespace headway::objects
