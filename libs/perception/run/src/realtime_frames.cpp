// SPDX-License-Identifier: BSD-3-Clause
// Frames of a recording at the rate of a live camera.
#include <headway/run/session.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

namespace headway::run {
namespace {

constexpr double kMaxGapS = 5.0;

class RealtimeFrames final : public Source {
 public:
  RealtimeFrames(std::unique_ptr<Source> source, double factor, std::size_t capacity)
      : source_(std::move(source)), factor_(factor), capacity_(capacity) {}

  ~RealtimeFrames() override { RealtimeFrames::close(); }

  [[nodiscard]] std::string name() const override { return source_->name(); }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return source_->camera(); }
  [[nodiscard]] bool dropsLateFrames() const override { return true; }
  [[nodiscard]] std::optional<io::CalibrationReport> calibration() const override {
    return source_->calibration();
  }

  void close() override {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    if (thread_.joinable()) thread_.join();
  }

  [[nodiscard]] std::optional<LiveFrame> next(const StopCondition& stop) override {
    if (!thread_.joinable()) thread_ = std::thread([this] { readAll(); });
    std::unique_lock lock(mutex_);
    while (queue_.empty() && !finished_ && !stop()) {
      changed_.wait_for(lock, std::chrono::milliseconds(100));  // stop() wakes nobody
    }
    if (stop()) return std::nullopt;
    if (queue_.empty()) {
      if (error_) std::rethrow_exception(error_);
      return std::nullopt;
    }
    auto frame = std::move(queue_.front());
    queue_.pop_front();
    return frame;
  }

  [[nodiscard]] SourceReport report() const override {
    SourceReport report;
    if (!thread_.joinable()) report = source_->report();
    const std::lock_guard lock(mutex_);
    report.dropped = dropped_;
    report.progress = progress_;
    return report;
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
      while (auto live = source_->next([this] { return isStopping(); })) {
        RecordedFrame* frame = &live->frame;
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
        const auto due_at = *start + std::chrono::duration_cast<Clock::duration>(due);
        if (!hand(std::move(*frame), due_at, source_->report().progress)) break;
      }
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    error_ = error;
    finished_ = true;
    changed_.notify_all();
  }

  [[nodiscard]] bool isStopping() const {
    const std::lock_guard lock(mutex_);
    return stopping_;
  }

  /// Queues a frame once it is due. @return false if the source is being closed
  bool hand(RecordedFrame frame, Clock::time_point due, double progress) {
    std::unique_lock lock(mutex_);
    while (Clock::now() < due && !stopping_) changed_.wait_until(lock, due);
    if (stopping_) return false;
    progress_ = progress;
    if (queue_.size() == capacity_) {
      const RecordedFrame dropped = std::move(queue_.front().frame);
      queue_.pop_front();
      ++dropped_;
      RecordedFrame& next = queue_.empty() ? frame : queue_.front().frame;
      if (dropped.stereo && next.stereo) {
        next.stereo->motion_prior = joined(*dropped.stereo, next.stereo->motion_prior);
      }
    }
    queue_.push_back({std::move(frame), monotonicSeconds()});
    changed_.notify_all();
    return true;
  }

  std::unique_ptr<Source> source_;
  double factor_;
  std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<LiveFrame> queue_;  // guarded by mutex_, like the members below
  std::size_t dropped_ = 0;
  double progress_ = 0.0;
  bool stopping_ = false;
  bool finished_ = false;
  std::exception_ptr error_;
  std::thread thread_;  // of the consumer
};

}  // namespace

std::unique_ptr<Source> inRealtime(std::unique_ptr<Source> source, double factor,
                                   std::size_t capacity) {
  return std::make_unique<RealtimeFrames>(std::move(source), factor, capacity);
}

}  // namespace headway::run
