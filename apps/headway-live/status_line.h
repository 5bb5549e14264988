// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/pipeline/perception.h>

#include <atomic>
#include <cstddef>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace headway::live {

/// Prints one line a second in a thread of its own: pose, tracking, tracks, latency and drops.
///
/// Calls back about every 50 ms, also while no frames arrive.
class StatusLine {
 public:
  /// @param quiet  prints nothing
  /// @param poll   called by the thread
  /// @param wait   text appended while there has been no frame, called by the thread
  StatusLine(bool quiet, std::function<void()> poll, std::function<std::string()> wait);
  ~StatusLine();
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// Results of a frame.
  ///
  /// @param dropped   frames so far
  /// @param left_out  because of the load; may be empty
  void update(const pipeline::PerceptionUpdate& update, double latency_s, std::size_t dropped,
              const std::string& left_out);

 private:
  void run();
  [[nodiscard]] std::string text();

  bool quiet_;
  std::function<void()> poll_;
  std::function<std::string()> wait_;
  std::mutex mutex_;
  std::optional<pipeline::PerceptionUpdate> last_;  // guarded by mutex_, like the members below
  double max_latency_s_ = 0.0;                      ///< since the last line
  std::size_t frames_ = 0;                          ///< since the last line
  std::size_t dropped_ = 0;
  std::string left_out_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;  // last member, so that it starts after the others
};

}  // namespace headway::live
