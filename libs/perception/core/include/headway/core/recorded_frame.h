// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/gnss_fix.h>
#include <headway/core/laser_scan.h>
#include <headway/core/stereo_frame.h>

#include <optional>
#include <vector>

namespace headway {

/// One frame of a recording: a stereo pair and the data recorded with it.
struct RecordedFrame {
  std::size_t index = 0;  ///< of the stereo frame (of the pose, if there are no images), from 0
  Time time = 0.0;        ///< [s]
  std::optional<StereoFrame> stereo;     ///< empty: the recording has poses and boxes only
  std::optional<Detections> detections;  ///< empty: no detector ran on this frame
  std::optional<Pose> T_map_robot;       ///< to be used instead of visual SLAM
  std::vector<LaserScan> laser_scans;    ///< near this time, at most one of each laser
  double rectify_ms = 0.0;               ///< time for rectification and conversion to grey [ms]
  std::vector<GnssFix> gnss;             ///< since the frame before, of all receivers
};

}  // namespace headway
