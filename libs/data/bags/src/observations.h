// SPDX-License-Identifier: BSD-3-Clause
// Messages of ROS as images and observations of MRPT.
#pragma once

#include <headway/io/rawlog_sink.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationGPS.h>
#include <mrpt/obs/CObservationIMU.h>

#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <variant>

#include "bag_rig.h"
#include "messages.h"

namespace headway::bags {

/// A converted image, or the reason why there is none ("image_encoding_mono16", "broken_image").
using ConvertedImage = std::variant<cv::Mat, std::string>;

/// 8-bit grey or BGR; raw colours of a Bayer pattern are interpolated. Has its own pixels.
[[nodiscard]] ConvertedImage pictureFrom(const ImageMessage& message);
[[nodiscard]] ConvertedImage pictureFrom(const CompressedImageMessage& message);

/// Depth in millimetres, 16 bit; 0 where nothing was measured, and beyond 65.5 m.
[[nodiscard]] ConvertedImage depthFrom(const ImageMessage& message);
/// Of the transport compressedDepth.
[[nodiscard]] ConvertedImage depthFrom(const CompressedImageMessage& message);

/// A picture or depth image of either type of message. @throws BrokenData
[[nodiscard]] ConvertedImage convertImage(const BagTopic& topic, std::string_view message,
                                          bool is_depth, MessageHeader& header);

// Messages as observations of MRPT. Poses are those of the message's frame on the robot.

/// Samples in the axes of the robot.
[[nodiscard]] mrpt::obs::CObservationIMU::Ptr imuObservation(const ImuMessage& message, Time time,
                                                             const Pose& T_robot_imu);

/// A position as NMEA GGA, without velocity; the altitude is above the ellipsoid.
[[nodiscard]] mrpt::obs::CObservationGPS::Ptr gnssObservation(const NavSatFixMessage& message,
                                                              Time time,
                                                              const Pose& T_robot_antenna);

/// A scan from right to left; nullopt if its angles or ranges are none.
[[nodiscard]] std::optional<io::RecordedScan> scanFrom(const LaserScanMessage& message, Time time,
                                                       const Pose& T_robot_laser);

/// A picture with depth along the viewing direction, each with its own calibration. Messages do not
/// tell how far a camera measures: the maximum range is that of 16 bits.
///
/// @param depth  [mm], 0 where nothing was measured
[[nodiscard]] mrpt::obs::CObservation3DRangeScan::Ptr depthObservation(const cv::Mat& picture,
                                                                       const cv::Mat& depth,
                                                                       Time time,
                                                                       const BagRig& rig);

}  // namespace headway::bags
