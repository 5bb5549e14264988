// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>

#include <map>
#include <string>

namespace headway::io {

/// Reads the labelled objects of a KITTI raw drive (`tracklet_labels.xml`) by frame.
///
/// Ids are the tracklets' positions in the file. Boxes have no 2D box.
///
/// @param T_cam_velo  lidar frame in rectified camera 0, the frame of the resulting boxes
/// @param dropped     counts boxes outside the image ("tracklet_outside_image") and of other
///                    classes ("unknown_class")
/// @throws InputError naming the file and the tracklet of an error
[[nodiscard]] std::map<std::size_t, Detections> readKittiTracklets(
    const std::string& path, const Pose& T_cam_velo, std::map<std::string, std::size_t>& dropped);

}  // namespace headway::io
