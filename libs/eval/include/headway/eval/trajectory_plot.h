#pragma once

#include <headway/eval/trajectory_error.h>

#include <opencv2/core/mat.hpp>
#include <string>

namespace headway::eval {

/// Which two axes of the poses lie in the picture.
enum class TopView {
  kXy,  ///< robot and world frames: z is up
  kXz,  ///< camera frames (KITTI poses): y is down
};

/// Truth and estimate from above, the estimate coloured by its error, and the error over the path
/// below it. 8-bit BGR.
[[nodiscard]] cv::Mat trajectoryPlot(const TrajectoryError& error, TopView view,
                                     const std::string& title);

}  // namespace headway::eval
