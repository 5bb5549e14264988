// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/rawlog_sink.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>

namespace headway::io {

/// The lens as MRPT stores it. A lens without distortion has the model `none`.
[[nodiscard]] mrpt::img::TCamera mrptCamera(const RawCamera& camera, const std::string& name);

/// Replaces calibration and poses of a stereo observation, and marks a right image as present.
void setCalibration(const RawStereoCamera& camera,
                    mrpt::obs::CObservationStereoImages& observation);

/// Replaces calibration and pose of one image of a pair.
void setCalibration(const RawStereoCamera& camera, bool is_left,
                    mrpt::obs::CObservationImage& observation);

/// A frame of a depth camera, without time and label.
///
/// @param depth  16-bit, 0 where nothing was measured
[[nodiscard]] mrpt::obs::CObservation3DRangeScan::Ptr depthObservation(
    const mrpt::img::CImage& image, const cv::Mat& depth, const RawDepthCamera& camera);

}  // namespace headway::io
