#pragma once

#include <headway/core/detection.h>

#include <Eigen/Core>
#include <optional>

namespace headway::objects {

/// Predicts the image box of an object that moved relative to the camera.
///
/// No calibration is needed: the object's height and that of its box give the focal length, and the
/// pinhole model gives shift and scale.
///
/// @param box     as seen when the object was at `from` [px]
/// @param from    centre in the sensor's optical frame [m]
/// @param to      centre now, same frame [m]
/// @param height  of the object [m]
/// @return        nullopt where the object is no longer in front of the camera
[[nodiscard]] std::optional<Box2d> carriedBox(const Box2d& box, const Eigen::Vector3d& from,
                                              const Eigen::Vector3d& to, double height);

}  // namespace headway::objects
