// SPDX-License-Identifier: BSD-3-Clause
// The formats of bags, each of which is read in the file of its name.
#pragma once

#include <headway/bags/bag_reader.h>

#include <string>

namespace headway::bags {

inline constexpr std::string_view kMcapMagic = "\x89MCAP0\r\n";

/// Opens an MCAP file (version 0) with chunks compressed by lz4 or Zstandard, or not at all.
///
/// @throws InputError if it has no readable record
[[nodiscard]] std::unique_ptr<BagReader> openMcapBag(const std::string& path);

/// Opens a bag of ROS 1, format 2.0, also if its index is missing.
///
/// The format's records are read here and not by librosbag_storage, which trusts the offsets of a
/// file's index, allocates what the file asks for, and loads the plug-in that its header names: of
/// 300 damaged bags it crashed on 2, and refused 41 of which this reader refuses 9.
///
/// @throws InputError if it has another version, is encrypted, or has no readable record
[[nodiscard]] std::unique_ptr<BagReader> openRos1Bag(const std::string& path);

/// Opens a rosbag2 recording in an SQLite database (`.db3`).
///
/// @throws InputError if it is damaged or not of rosbag2, or if this build lacks SQLite
[[nodiscard]] std::unique_ptr<BagReader> openSqliteBag(const std::string& path);

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
