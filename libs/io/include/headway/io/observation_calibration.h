#pragma once

#include <headway/io/rawlog_sink.h>
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

}  // namespace headway::io
