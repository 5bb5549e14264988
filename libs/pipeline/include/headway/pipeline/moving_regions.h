#pragma once

#include <headway/core/detection.h>
#include <headway/core/moving_regions.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/detect/stereo_motion.h>

#include <optional>
#include <vector>

namespace headway::pipeline {

/// Boxes of this frame that move or may move, for SLAM to leave out.
///
/// A detection goes by the confirmed track that was seen where it is now (IoU >= 0.3) in the
/// previous frame: found moving, it leaves the map; known to stand, as a parked car, it stays.
/// Whatever is new, unknown, or not yet known to stand is unsure.
///
/// @param detections  of this frame
/// @param previous    tracks of the previous frame, with the boxes they were seen in
[[nodiscard]] MovingRegions movingRegions(const Detections& detections,
                                          const std::vector<Track>& previous,
                                          const StereoCamera& camera);

/// The same for several sources, with what `motion` found moving, where that is by now.
///
/// @param at  of the detections [s]
[[nodiscard]] MovingRegions movingRegions(const std::vector<Detections>& sources,
                                          const std::vector<Track>& previous,
                                          const detect::MotionDetections& motion, Time at,
                                          const StereoCamera& camera);

/// Adds regions of the same image.
void append(const MovingRegions& more, MovingRegions& all);

/// Where moving tracks are in the image now, those not seen in this frame, too.
///
/// @param tracks  of this frame
[[nodiscard]] MovingRegions movingRegions(const std::vector<Track>& tracks, const Pose& T_map_robot,
                                          const StereoCamera& camera);

/// The image box around a 3D box, clipped to the image.
///
/// @return [px]; nullopt if a corner is not in front of the camera or the box is out of view
[[nodiscard]] std::optional<Box2d> projectedBox(const Box3d& box, const StereoCamera& camera);

}  // namespace headway::pipeline
