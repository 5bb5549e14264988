// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/report/map_files.h>
#include <headway/report/replay_frames.h>

#include <opencv2/core/mat.hpp>

#include "foxglove.pb.h"

// What a replay is made of as Foxglove's messages, in the frames "map", "odom", "base_link" (the
// robot) and "camera".

namespace headway::exporting {

[[nodiscard]] foxglove::FrameTransforms transformsOf(const report::ReplayFrame& frame,
                                                     const Pose& T_robot_cam);
[[nodiscard]] foxglove::PoseInFrame poseOf(const report::ReplayFrame& frame);
/// Poses of the whole replay, at most some thousands, evenly spaced.
[[nodiscard]] foxglove::PosesInFrame pathOf(const std::vector<report::ReplayFrame>& frames);
[[nodiscard]] foxglove::CameraCalibration calibrationOf(Time time, const StereoCamera& camera);
/// @param image  grey or BGR
[[nodiscard]] foxglove::CompressedImage imageOf(Time time, const cv::Mat& image);
[[nodiscard]] foxglove::PointCloud cloudOf(Time time,
                                           const std::vector<report::ColouredPoint>& points);
/// Free cells in a light and occupied ones in a dark colour; unknown ones are transparent.
///
/// @throws InputError if its picture cannot be read
[[nodiscard]] foxglove::Grid gridOf(Time time, const report::GridFile& grid);
/// Boxes with their names; they replace those of the frame before.
[[nodiscard]] foxglove::SceneUpdate boxesOf(const report::ReplayFrame& frame);
/// Predicted paths of moving tracks, the more probable the more opaque, with ellipses of one
/// standard deviation at their ends; they replace those of the frame before.
[[nodiscard]] foxglove::SceneUpdate predictionsOf(const report::ReplayFrame& frame);

/// Nanoseconds since 1970.
[[nodiscard]] std::uint64_t nanoseconds(Time time);

}  // namespace headway::exporting
