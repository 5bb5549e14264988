// SPDX-License-Identifier: BSD-3-Clause
// Progress on a terminal, and interrupts.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

namespace headway::program {

/// Seconds as minutes and seconds, with hours if there are some: "0:07", "5:46", "2:05:46".
[[nodiscard]] std::string durationText(double seconds);

/// Progress on standard error: done/total, rate, time left.
///
/// One updated line on a terminal, a new line every 10 s otherwise, no output if quiet.
class Progress {
 public:
  Progress(std::string what, bool quiet);
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// @param done   items done so far
  /// @param ratio  completed ratio of the work, 0 to 1
  void update(std::size_t done, double ratio);
  /// Ends the line on a terminal. Further updates are ignored.
  void finish();

 private:
  std::string what_;
  bool silent_;
  bool terminal_;
  bool line_open_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_shown_;
};

/// Converts SIGINT (Ctrl-C), SIGTERM and SIGHUP to a stop request (core/worker_thread.h), so that
/// loops can end cleanly; a second signal ends the program at once. Under nohup, SIGHUP
/// remains ignored.
void catchInterrupts();

/// Whether such a signal was received since catchInterrupts().
[[nodiscard]] bool interrupted();

}  // namespace headway::program
