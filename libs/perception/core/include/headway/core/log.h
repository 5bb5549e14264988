// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>

namespace headway {

/// Importance of a message, as MRPT's verbosity levels.
enum class LogLevel {
  kDebug,  ///< decisions of a frame
  kInfo,   ///< events such as a closed loop
  kWarn,   ///< results are degraded
};

/// Receives messages of one line each, in the thread that processes; empty: none are made.
///
///     perception.setLog([&](LogLevel level, const std::string& text) { logger.log(...); });
using LogSink = std::function<void(LogLevel, const std::string&)>;

}  // namespace headway
