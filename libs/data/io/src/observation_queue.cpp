// SPDX-License-Identifier: BSD-3-Clause
#include <headway/io/observation_queue.h>
#include <mrpt/core/exceptions.h>

namespace headway::io {

ObservationQueue::ObservationQueue(std::size_t capacity) : capacity_(capacity) {
  ASSERTMSG_(capacity >= 1, "the queue capacity must be at least 1");
}

void ObservationQueue::push(const mrpt::obs::CObservation::Ptr& observation) {
  if (observation == nullptr) return;
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    if (waiting_.size() == capacity_) {
      waiting_.pop_front();
      ++dropped_;
    }
    waiting_.push_back(observation);
  }
  changed_.notify_one();
}

void ObservationQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

mrpt::obs::CObservation::Ptr ObservationQueue::pop() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
  if (waiting_.empty()) return nullptr;
  auto observation = waiting_.front();
  waiting_.pop_front();
  return observation;
}

std::size_t ObservationQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace headway::io
