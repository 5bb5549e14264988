// SPDX-License-Identifier: BSD-3-Clause
// A frame of a recording or of live sensors, with all that was recorded for it.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/pose.h>
#include <headway/core/stereo_frame.h>

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace headway {

/// A position measured by a satellite receiver.
struct GnssFix {
  Time time = 0.0;                                    ///< [s]
  Eigen::Vector3d antenna = Eigen::Vector3d::Zero();  ///< robot frame [m]
  double latitude_deg = 0.0;                          ///< WGS 84, north positive
  double longitude_deg = 0.0;                         ///< WGS 84, east positive
  double altitude_m = 0.0;                            ///< above the ellipsoid
  double sigma_m = 1.0;                               ///< of each horizontal axis
};

/// A scan of a 2D laser, its beams taken at one time.
struct LaserScan {
  std::string label;                      ///< of the sensor
  Time time = 0.0;                        ///< [s]
  Pose T_robot_laser = Pose::Identity();  ///< the beams lie in the laser's xy plane
  double sigma_m = 0.02;                  ///< of a range [m]
  std::vector<Eigen::Vector2f> ends;      ///< of the beams with a valid range, laser frame [m]
};

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

/// Seconds of a clock that never goes back; tests replace it.
using MonotonicClock = std::function<double()>;

/// Seconds of the machine's monotonic clock, of unspecified origin.
[[nodiscard]] inline double monotonicSeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A frame of live sensors.
struct LiveFrame {
  RecordedFrame frame;
  double arrival_s = 0.0;  ///< when its second image arrived, by a MonotonicClock [s]
};

}  // namespace headway
