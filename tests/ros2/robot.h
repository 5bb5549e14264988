// SPDX-License-Identifier: BSD-3-Clause
// A robot that plays a rawlog as its sensors, by another implementation of DDS.
#pragma once

#include <headway/core/pose.h>

#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "fast_dds_peer.h"

namespace headway::test {

/// Frames of a rawlog, with what the other sensors say between them.
struct Part {
  std::size_t first = 0;
  std::size_t end = std::numeric_limits<std::size_t>::max();  ///< behind the last one
  double shift_s = 0.0;                                       ///< added to all times, too
};

/// Publishes the observations of a rawlog at their rate: /left and /right with camera_info, or
/// /color and /depth, /imu, /odom, /scan, /fix, /tf_static, and /tf odom -> base_link of the
/// wheels.
class Robot {
 public:
  /// @param is_compressed  sends images as JPEG, depth as PNG
  /// @param shift_s        added to all times
  /// @param is_reliable    false: all but transforms is sent with best effort, as drivers do
  Robot(FastDdsPeer& peer, std::string rawlog, bool is_compressed = false, double shift_s = 0.0,
        bool is_reliable = true);
  ~Robot();

  /// Whether somebody subscribes to the images.
  [[nodiscard]] bool isWatched() const;
  /// @return number of frames sent
  std::size_t play(double factor, const std::atomic<bool>& stop, const Part& part = {});
  /// Messages sent by topic.
  [[nodiscard]] const std::map<std::string, std::size_t>& sent() const;
  /// Called before a frame's images are sent, and when they were.
  std::function<void(Time)> before_frame, on_frame;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Frames whose odometry headway has published.
class Results {
 public:
  explicit Results(FastDdsPeer& peer);

  [[nodiscard]] static long keyOf(Time time) { return std::lround(1e4 * time); }
  [[nodiscard]] std::set<long> stamps() const;
  /// Waits for a frame that was sent, for half a second until there was any: so no machine is too
  /// slow for a robot.
  void await(Time time) const;

 private:
  mutable std::mutex mutex_;
  std::set<long> stamps_;  // guarded by mutex_
  std::unique_ptr<FastDdsPeer::Reader> odometry_;
};

}  // namespace headway::test
