// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/obs/CObservation.h>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>

namespace headway::io {

/// Queue of observations from sensor callbacks to the perception thread.
///
/// push() never blocks: if the queue is full, the oldest observation is dropped and counted. Any
/// number of threads may push; one thread pops.
///
///     ObservationQueue queue;
///     driver.onObservation([&](const auto& observation) { queue.push(observation); });
///     RawlogSource source(queue, {});  // in the perception thread
class ObservationQueue {
 public:
  /// @param capacity  maximum number of waiting observations, >= 1
  explicit ObservationQueue(std::size_t capacity = 200);

  /// Adds an observation; null pointers and calls after close() are ignored.
  void push(const mrpt::obs::CObservation::Ptr& observation);

  /// Ends the input: pop() returns the waiting observations, then null.
  void close();

  /// Waits for the next observation; null once the queue is closed and empty.
  [[nodiscard]] mrpt::obs::CObservation::Ptr pop();

  /// Number of observations dropped because the queue was full.
  [[nodiscard]] std::size_t dropped() const;

 private:
  std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<mrpt::obs::CObservation::Ptr> waiting_;  ///< guarded by mutex_, like the members below
  std::size_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace headway::io
