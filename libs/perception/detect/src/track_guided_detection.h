// SPDX-License-Identifier: BSD-3-Clause
// Detection of objects that the tracker expects, by less evidence: their appearance.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>

#include <vector>

#include "moving_object_finder.h"

namespace headway::detect {

/// An expected object as the newest frame of the camera path should show it.
struct SearchedObject {
  TrackId track;
  ObjectClass object_class = ObjectClass::kUnknown;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< expected, world of the path [m]
  MeasuredVelocity velocity;                           ///< world of the path
  int observations = 0;
  std::int64_t group = -1;                               ///< of the parts it had; -1: none
  Time last_motion = 0.0;                                ///< [s]
  Pose T_cam_then = Pose::Identity();                    ///< camera of the template seen from now
  std::shared_ptr<const AppearanceTemplate> appearance;  ///< null: none
};

/// The expected objects that a frame is searched for: those with evidence of motion within the
/// last second.
///
/// @param path        its newest frame is the searched one
/// @param T_map_cam   pose of that frame as given
[[nodiscard]] std::vector<SearchedObject> searchedObjects(
    const std::vector<ExpectedObject>& expected, const CameraPath& path, const Pose& T_map_cam);

/// The searched objects that no moving object explains: none is of the same group of points, and
/// none is near the expected place. Each moving object explains one.
[[nodiscard]] std::vector<SearchedObject> withoutFound(std::vector<SearchedObject> searched,
                                                       const std::vector<MovingObject>& found,
                                                       const CameraPath& path);

/// Detects searched objects by their appearance templates where stereo does not show them: half
/// hidden, or at the edge of the image that the other camera does not see.
///
/// An object that stopped is not reported as moving: the match must be nearer to the expected place
/// than to the one where the object was seen last. Its distance is the expected one, the more
/// uncertain the longer ago it was measured; where stereo shows something farther, it is not
/// detected. Objects observed in a single frame are not searched.
///
/// @param beyond_m  depth up to which changes of EmptySpace show what is there: of 61 rows in
///                  robots' worlds that nothing was behind, 41 had come from this search there
/// @param found     in this frame already: what is part of one of them is left out; others are
///                  appended
void detectByAppearance(const MotionFrame& frame, const std::vector<SearchedObject>& searched,
                        double beyond_m, const StereoCamera& camera,
                        std::vector<MovingObject>& found);

}  // namespace headway::detect
