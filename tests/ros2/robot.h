// SPDX-License-Identifier: BSD-3-Clause
// A robot that plays a rawlog as its sensors, by another implementation of DDS.
#pragma once

#include <headway/core/pose.h>

#include <atomic>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>

#include "fast_dds_peer.h"

namespace headway::test {

/// Publishes the observations of a rawlog at their rate: /left and /right with camera_info, or
/// /color and /depth, /imu, /odom, /scan, /fix, /tf_static, and /tf odom -> base_link of the
/// wheels.
class Robot {
 public:
  /// @param is_compressed  sends stereo images as JPEG
  /// @param shift_s        added to all times
  Robot(FastDdsPeer& peer, std::string rawlog, bool is_compressed = false, double shift_s = 0.0);
  ~Robot();

  /// Whether somebody subscribes to the images.
  [[nodiscard]] bool isWatched() const;
  /// Until the end of the rawlog or the number of frames. @return number of frames sent
  std::size_t play(double factor, const std::atomic<bool>& stop,
                   std::size_t max_frames = std::numeric_limits<std::size_t>::max());
  /// Messages sent by topic.
  [[nodiscard]] const std::map<std::string, std::size_t>& sent() const;
  /// Called when a frame's second image is sent, with its time and the monotonic clock's.
  std::function<void(Time, double)> on_frame;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::test
