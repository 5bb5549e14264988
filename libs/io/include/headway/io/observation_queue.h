#pragma once

#include <mrpt/obs/CObservation.h>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>

namespace headway::io {

/// Observations on their way from sensors' callbacks to the perception thread.
///
/// push() never waits: where perception is late, the oldest observation is given up and counted.
/// Any number of threads push, one pops.
///
///     ObservationQueue queue;
///     driver.onObservation([&](const auto& observation) { queue.push(observation); });
///     RawlogSource source(queue, {});  // in the perception thread, as if read from a file
class ObservationQueue {
 public:
  /// @param capacity  >= 1, of observations that wait
  explicit ObservationQueue(std::size_t capacity = 200);

  /// Takes an observation in; null ones and those after close() are ignored.
  void push(const mrpt::obs::CObservation::Ptr& observation);

  /// No more will come: pop() hands out what waits, and then null.
  void close();

  /// Waits for the next observation; null once the queue is closed and empty.
  [[nodiscard]] mrpt::obs::CObservation::Ptr pop();

  /// Observations given up because the queue was full.
  [[nodiscard]] std::size_t dropped() const;

 private:
  std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<mrpt::obs::CObservation::Ptr> waiting_;  ///< guarded by mutex_, as what follows
  std::size_t dropped_ = 0;
  bool closed_ = false;
};

}  // namespace headway::io
