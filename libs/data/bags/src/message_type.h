// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_reader.h>

#include <string>

namespace headway::bags {

/// "sensor_msgs/msg/Image" as "sensor_msgs/Image".
[[nodiscard]] inline std::string ros1TypeOf(std::string type) {
  const auto middle = type.find("/msg/");
  if (middle != std::string::npos) type.erase(middle, 4);
  return type;
}

/// Of "cdr" and "ros1", as MCAP and rosbag2 name them.
[[nodiscard]] inline Encoding encodingOf(const std::string& name) {
  if (name == "cdr") return Encoding::kCdr;
  return name == "ros1" ? Encoding::kRos1 : Encoding::kOther;
}

}  // namespace headway::bags
