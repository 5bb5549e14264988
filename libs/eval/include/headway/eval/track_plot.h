#pragma once

#include <headway/eval/track_error.h>

#include <opencv2/core/mat.hpp>

namespace headway::eval {

/// MOTA and scaled MOTA over recall, a colour for each class. 8-bit BGR.
[[nodiscard]] cv::Mat trackPlot(const TrackErrors& errors);

}  // namespace headway::eval
