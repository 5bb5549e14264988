// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/stop_request.h>
#include <headway/pipeline/frame_feed.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

namespace headway::pipeline {
namespace {

constexpr double kMaxGapS = 5.0;
constexpr std::chrono::milliseconds kPollInterval(100);  // of a stop request

class OfflineFeed : public FrameFeed {
 public:
  explicit OfflineFeed(FrameReader reader) : reader_(std::move(reader)) {}
  std::optional<RecordedFrame> next() override { return reader_(); }
  [[nodiscard]] std::size_t dropped() const override { return 0; }

 private:
  FrameReader reader_;
};

class RealtimeFeed : public FrameFeed {
 public:
  RealtimeFeed(FrameReader reader, double factor, std::size_t capacity)
      : reader_(std::move(reader)),
        factor_(factor),
        capacity_(capacity),
        thread_([this] { readAll(); }) {}

  ~RealtimeFeed() override {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  std::optional<RecordedFrame> next() override {
    std::unique_lock lock(mutex_);
    while (queue_.empty() && !finished_ && !stopRequested()) changed_.wait_for(lock, kPollInterval);
    if (stopRequested()) return std::nullopt;
    if (queue_.empty()) {
      if (error_) std::rethrow_exception(error_);
      return std::nullopt;
    }
    auto frame = std::move(queue_.front());
    queue_.pop_front();
    return frame;
  }

  [[nodiscard]] std::size_t dropped() const override {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  using Clock = std::chrono::steady_clock;

  void readAll() {
    std::exception_ptr error;
    try {
      std::optional<Clock::time_point> start;
      Time first = 0.0;
      Time last = 0.0;
      Time interval = 0.0;  // between the last two frames
      while (auto frame = reader_()) {
        if (!start) {
          start = Clock::now();
          first = last = frame->time;
        }
        // A pause of the recording is not waited for.
        if (frame->time - last > kMaxGapS) first += frame->time - last - kMaxGapS;
        // A clock that was set back: its frames follow at the pace of those before.
        if (frame->time < last) first += frame->time - last - interval;
        if (frame->time >= last) interval = std::min(frame->time - last, kMaxGapS);
        last = frame->time;
        const std::chrono::duration<double> due((frame->time - first) / factor_);
        if (!hand(std::move(*frame), *start + std::chrono::duration_cast<Clock::duration>(due))) {
          break;
        }
      }
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    error_ = error;
    finished_ = true;
    changed_.notify_all();
  }

  /// Queues a frame once it is due. @return false if the feed is being closed
  bool hand(RecordedFrame frame, Clock::time_point due) {
    std::unique_lock lock(mutex_);
    while (Clock::now() < due) {
      if (stopping_ || stopRequested()) return false;
      changed_.wait_until(lock, std::min(due, Clock::now() + kPollInterval));
    }
    if (stopping_) return false;
    if (queue_.size() == capacity_) {
      const RecordedFrame dropped = std::move(queue_.front());
      queue_.pop_front();
      ++dropped_;
      RecordedFrame& next = queue_.empty() ? frame : queue_.front();
      if (dropped.stereo && next.stereo) {
        next.stereo->motion_prior = joined(*dropped.stereo, next.stereo->motion_prior);
      }
    }
    queue_.push_back(std::move(frame));
    changed_.notify_all();
    return true;
  }

  FrameReader reader_;
  double factor_;
  std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<RecordedFrame> queue_;  // guarded by mutex_, like the members below
  std::size_t dropped_ = 0;
  bool stopping_ = false;
  bool finished_ = false;
  std::exception_ptr error_;
  std::thread thread_;  // last member, so that it starts after the others
};

}  // namespace

std::unique_ptr<FrameFeed> makeOfflineFeed(FrameReader reader) {
  return std::make_unique<OfflineFeed>(std::move(reader));
}

std::unique_ptr<FrameFeed> makeRealtimeFeed(FrameReader reader, double factor,
                                            std::size_t capacity) {
  return std::make_unique<RealtimeFeed>(std::move(reader), factor, capacity);
}

}  // namespace headway::pipeline
