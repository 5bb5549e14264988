// SPDX-License-Identifier: BSD-3-Clause
// Progress on a terminal, and interrupts.
#include <headway/core/worker_thread.h>
#include <headway/program/command_line.h>
#include <headway/program/progress.h>
#include <mrpt/system/progress.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <ctime>

namespace headway::program {
namespace {

std::atomic<std::int64_t> first_interrupt_ms{0};

/// The first signal asks for a clean end, a later one ends the program. Within 0.3 s it is the same
/// one: timeout(1) and others send it to a process and then to its group.
extern "C" void onInterrupt(int signal) {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  const std::int64_t now_ms = std::int64_t{1000} * now.tv_sec + now.tv_nsec / 1000000;
  if (!stopRequested()) {
    first_interrupt_ms = now_ms;
    requestStop(signal);
  } else if (now_ms - first_interrupt_ms > 300) {
    _exit(kSignalled + signal);
  }
}

double secondsBetween(std::chrono::steady_clock::time_point from,
                      std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

std::string durationText(double seconds) {
  const long whole = std::lround(std::min(std::max(0.0, seconds), 1e9));
  char text[32];
  if (whole < 3600) {
    std::snprintf(text, sizeof text, "%ld:%02ld", whole / 60, whole % 60);
  } else {
    std::snprintf(text, sizeof text, "%ld:%02ld:%02ld", whole / 3600, whole / 60 % 60, whole % 60);
  }
  return text;
}

Progress::Progress(std::string what, bool quiet)
    : what_(std::move(what)),
      silent_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      last_shown_(start_) {}

void Progress::update(std::size_t done, double ratio) {
  if (silent_) return;
  const auto now = std::chrono::steady_clock::now();
  if (secondsBetween(last_shown_, now) < (terminal_ ? 0.25 : 10.0)) return;
  last_shown_ = now;
  line_open_ = terminal_;
  const double elapsed = secondsBetween(start_, now);
  const double left = ratio > 0.0 ? elapsed * (1.0 - ratio) / ratio : 0.0;
  const auto total = ratio > 0.0 ? static_cast<double>(done) / ratio : 0.0;
  std::fprintf(stderr, "%s%s %s %zu/%.0f, %.1f/s, %s left%s", terminal_ ? "\r" : "", what_.c_str(),
               mrpt::system::progress(ratio, 30).c_str(), done, total,
               static_cast<double>(done) / elapsed, durationText(left).c_str(),
               terminal_ ? "\033[K" : "\n");
  std::fflush(stderr);
}

void Progress::finish() {
  if (line_open_) std::fprintf(stderr, "\n");
  line_open_ = false;
  silent_ = true;
}

void catchInterrupts() {
  requestStop(0);
  struct sigaction action {};
  action.sa_handler = onInterrupt;
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction old {};
    sigaction(signal, nullptr, &old);
    const bool is_under_nohup = signal == SIGHUP && old.sa_handler == SIG_IGN;
    if (!is_under_nohup) sigaction(signal, &action, nullptr);
  }
}

bool interrupted() { return stopRequested(); }

}  // namespace headway::program
