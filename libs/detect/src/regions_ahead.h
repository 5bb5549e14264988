#pragma once

#include <headway/core/moving_regions.h>
#include <headway/detect/stereo_motion.h>

#include <opencv2/core/mat.hpp>
#include <vector>

#include "camera_path.h"

namespace headway::detect {

/// Where moving objects will be in the image if they and the camera go on as they did.
///
/// @param cells   of each object: column and row in the disparity image of the newest frame
/// @param reduce  pixels to one such cell, each way
/// @param ahead   of the newest frame of the path [s]
[[nodiscard]] MovingRegions regionsAhead(const std::vector<MovingObject>& objects,
                                         const std::vector<std::vector<cv::Point>>& cells,
                                         int reduce, const CameraPath& path,
                                         const StereoCamera& camera, double ahead);

}  // namespace headway::detect
