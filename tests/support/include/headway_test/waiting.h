// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway_test/repeats.h>

#include <chrono>
#include <thread>

namespace headway::test {

/// Waits until a condition holds, at most a minute, or ten where a sanitizer slows programs down.
///
/// @return whether it holds
template <typename Condition>
bool waitUntil(const Condition& holds) {
  constexpr int kMaxPolls = kSanitized ? 60000 : 6000;
  for (int poll = 0; poll < kMaxPolls; ++poll) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

}  // namespace headway::test
