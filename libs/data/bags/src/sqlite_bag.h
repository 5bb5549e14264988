// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_reader.h>

#include <string>

namespace headway::bags {

/// Opens a rosbag2 recording in an SQLite database (`.db3`).
///
/// @throws InputError if it is damaged or not of rosbag2, or if this build lacks SQLite
[[nodiscard]] std::unique_ptr<BagReader> openSqliteBag(const std::string& path);

}  // namespace headway::bags
