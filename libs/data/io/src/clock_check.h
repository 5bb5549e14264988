// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/log.h>
#include <headway/core/pose.h>

#include <map>
#include <optional>
#include <string>

namespace headway::io {

/// Recognises sensors whose times are of another clock than the images' times.
///
/// Observations arrive in the order of measurement, but for latencies. The newest time of each
/// sensor is compared with that of each image as it arrives; a sensor without new observations,
/// such as one that is unplugged, is not compared.
class ClockCheck {
 public:
  /// Takes an observation of another sensor than the left camera.
  void addSample(const std::string& label, Time time);
  /// Takes a left image. Adds "clocks_differ_SENSOR" for each sensor that has differed by more than
  /// a second in ten successive images.
  void addImage(std::size_t frame, Time time, Warnings& warnings);

 private:
  struct Sensor {
    std::optional<Time> newest;  ///< since the last image
    int images = 0;              ///< successive ones that it differs from
  };
  std::map<std::string, Sensor> sensors_;
};

}  // namespace headway::io
