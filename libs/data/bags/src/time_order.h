// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <headway/io/rawlog_sink.h>

#include <functional>
#include <map>
#include <optional>
#include <utility>

namespace headway::bags {

/// Puts observations in the order of their own times: images arrive later than samples of the same
/// moment, because they take time to expose and to send.
class TimeOrder {
 public:
  struct Event {
    Time time = 0.0;
    const char* kind = nullptr;  ///< of what is counted when written; null: a frame
    std::size_t bytes = 0;
    std::function<void(io::RawlogSink&)> write;
  };

  void add(Event event) {
    bytes_ += event.bytes;
    newest_ = waiting_.empty() ? event.time : std::max(newest_, event.time);
    const Time time = event.time;
    waiting_.emplace(time, std::move(event));
  }

  /// The earliest event, if no earlier one is to be expected any more.
  [[nodiscard]] std::optional<Event> next(bool at_end) {
    if (waiting_.empty()) return std::nullopt;
    const bool is_due = at_end || newest_ - waiting_.begin()->first > kMaxDelay ||
                        bytes_ > kMaxBytes || waiting_.size() > kMaxEvents;
    if (!is_due) return std::nullopt;
    Event event = std::move(waiting_.begin()->second);
    waiting_.erase(waiting_.begin());
    bytes_ -= event.bytes;
    return event;
  }

 private:
  static constexpr double kMaxDelay = 1.0;  // [s]
  static constexpr std::size_t kMaxBytes = 1 << 28;
  static constexpr std::size_t kMaxEvents = 100000;

  std::multimap<Time, Event> waiting_;
  Time newest_ = 0.0;
  std::size_t bytes_ = 0;
};

}  // namespace headway::bags
