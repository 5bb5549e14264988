// SPDX-License-Identifier: BSD-3-Clause
// Messages of the libraries, and warnings that count how often a condition occurred.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
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

/// A condition of the input that degrades the results, and that the user can change.
struct Warning {
  std::size_t count = 0;        ///< frames or observations concerned
  std::size_t first_frame = 0;  ///< index of the first frame concerned
  std::string text;             ///< what is wrong and what to do, one line
};

/// Warnings by name, such as "bad_accelerometer".
using Warnings = std::map<std::string, Warning>;

/// Counts a warning; text and frame of its first occurrence are kept.
inline void addWarning(const std::string& name, std::size_t frame, const std::string& text,
                       Warnings& warnings, std::size_t count = 1) {
  const auto [warning, is_new] = warnings.try_emplace(name, Warning{0, frame, text});
  warning->second.count += count;
}

}  // namespace headway
