// SPDX-License-Identifier: BSD-3-Clause
// Depth images in rawlogs: their objects, files and calibration.
#pragma once

#include <headway/io/rawlog_sink.h>
#include <mrpt/obs/CObservation3DRangeScan.h>

#include <opencv2/core/mat.hpp>
#include <string>
#include <variant>

#include "object_reader.h"

namespace headway::io {

/// The depth image of a recorded frame and how it is to be read.
struct RecordedDepth {
  cv::Mat ranges;    ///< 16-bit, 0 where nothing was measured; empty if external
  std::string file;  ///< of an external image; empty if it is not
  RawDepthCamera camera;
};

/// Reads the values of a CObservation3DRangeScan after its class name, versions 0 to 10.
///
/// Points, confidence and further layers are not read into memory. Float ranges of versions before
/// 9 become millimetres, as in MRPT. Frames with labelled pixels are refused.
///
/// @throws BrokenObject if it cannot be read
[[nodiscard]] mrpt::obs::CObservation::Ptr readDepthScan(ObjectReader& in);

/// The depth image and its calibration; the image's memory is that of the observation's copy.
[[nodiscard]] RecordedDepth depthOf(const mrpt::obs::CObservation3DRangeScan& scan);

/// Ranges of a recorded depth image, loaded if they are external, or the reason of a failure
/// ("missing_depth", "broken_depth", "depth_outside_folder").
///
/// @param image_folder  folder of external images
[[nodiscard]] std::variant<cv::Mat, std::string> rangesOf(const RecordedDepth& depth,
                                                          const std::string& image_folder);

}  // namespace headway::io
