#pragma once

#include <headway/core/detection.h>

#include <Eigen/Core>
#include <optional>

namespace headway::objects {

/// Where the image box of an object goes as the object moves in front of the camera.
///
/// No calibration is needed: an object of known height tells the focal length by the height of its
/// own box, and the box shifts and grows as the pinhole model says.
///
/// @param box     as seen when the object was at `from` [px]
/// @param from    centre in the sensor's optical frame [m]
/// @param to      centre now, same frame [m]
/// @param height  of the object [m]
/// @return        nullopt where the object is no longer in front of the camera
[[nodiscard]] std::optional<Box2d> carriedBox(const Box2d& box, const Eigen::Vector3d& from,
                                              const Eigen::Vector3d& to, double height);

}  // namespace headway::objects
