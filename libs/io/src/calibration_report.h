#pragma once

#include <headway/io/rawlog_source.h>

#include <opencv2/core/mat.hpp>

namespace headway::io {

/// Measures what a rectified pair's images say of its calibration.
///
/// Corners of both images are matched along rows, to the right as well as to the left, so that
/// swapped images show as a negative median disparity. Cheap: a few milliseconds.
///
/// @param left, right  rectified, 8-bit grey
/// @return             medians are 0 if there are no matches, as in a picture of nothing
[[nodiscard]] CalibrationReport measureCalibration(const cv::Mat& left, const cv::Mat& right,
                                                   const StereoCamera& camera);

/// Throws InputError if the report says that left and right images are swapped.
void requireNotSwapped(const CalibrationReport& report);

}  // namespace headway::io
