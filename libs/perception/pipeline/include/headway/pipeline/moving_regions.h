// SPDX-License-Identifier: BSD-3-Clause
// Regions of an image that moving objects cover, or may cover.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/moving_regions.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/detect/stereo_motion.h>

#include <optional>
#include <vector>

namespace headway::pipeline {

/// Boxes of moving or possibly moving objects in this frame, to be excluded by SLAM.
///
/// A detection is classified by the confirmed track at its position in the previous frame (IoU >=
/// 0.3): excluded if moving, kept in the map if static, such as a parked car. Detections without
/// such a track, or with an unclassified one, are unsure.
///
/// @param detections  of this frame
/// @param previous    tracks of the previous frame, with their image boxes
[[nodiscard]] MovingRegions movingRegions(const Detections& detections,
                                          const std::vector<Track>& previous,
                                          const StereoCamera& camera);

/// The same for several sources, and the moving objects of `motion` at their current positions.
///
/// @param at  time of the detections [s]
[[nodiscard]] MovingRegions movingRegions(const std::vector<Detections>& sources,
                                          const std::vector<Track>& previous,
                                          const detect::MotionDetections& motion, Time at,
                                          const StereoCamera& camera);

/// Adds regions of the same image.
void append(const MovingRegions& more, MovingRegions& all);

/// Image regions of moving tracks, including those not observed in this frame.
///
/// @param tracks  of this frame
[[nodiscard]] MovingRegions movingRegions(const std::vector<Track>& tracks, const Pose& T_map_robot,
                                          const StereoCamera& camera);

/// Image regions of all that may move later, a quarter wider and higher than their boxes, which are
/// not exact: detections of anything but vehicles, and tracks, observed or not, except of vehicles
/// that are classified as static. What is neither observed nor predicted in a frame is not in them.
///
/// @param detections  of this frame
/// @param tracks      of this frame
[[nodiscard]] MovingRegions movableRegions(const Detections& detections,
                                           const std::vector<Track>& tracks,
                                           const Pose& T_map_robot, const StereoCamera& camera);

/// The image box around the part of a 3D box in front of the camera, clipped to the image.
///
/// @return [px]; nullopt if all corners are behind the camera or the box is out of view
[[nodiscard]] std::optional<Box2d> projectedBox(const Box3d& box, const StereoCamera& camera);

}  // namespace headway::pipeline
