// SPDX-License-Identifier: BSD-3-Clause
// The newest frame of live observations.
#include <headway/core/error.h>
#include <headway/io/live_source.h>
#include <mrpt/core/exceptions.h>

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <utility>

#include "frame_collector.h"
#include "frame_decoder.h"
#include "observation_selection.h"
#include "observation_stream.h"

namespace headway::io {
namespace {

constexpr const char* kName = "live observations";  // in messages
constexpr double kPatience_s = 2.0;  // for the first image that can be used: drivers start in less

/// Observations that were pushed and not yet read.
class PushedObservations : public ObservationReader {
 public:
  void push(const mrpt::obs::CObservation::Ptr& observation) { waiting_.push_back(observation); }
  [[nodiscard]] mrpt::obs::CObservation::Ptr next() override {
    if (waiting_.empty()) return nullptr;
    auto observation = waiting_.front();
    waiting_.pop_front();
    return observation;
  }
  [[nodiscard]] const std::optional<std::string>& truncation() const override { return none_; }
  [[nodiscard]] double progress() const override { return 0.0; }

 private:
  std::deque<mrpt::obs::CObservation::Ptr> waiting_;
  std::optional<std::string> none_;
};

void addCounts(const std::map<std::string, std::size_t>& from,
               std::map<std::string, std::size_t>& to) {
  for (const auto& [reason, count] : from) to[reason] += count;
}

}  // namespace

/// Two groups of members: those guarded by mutex_, which push() uses, and the consumer's.
class LiveSource::Implementation {
 public:
  Implementation(const LiveSourceOptions& options, MonotonicClock clock)
      : options_(options), clock_(std::move(clock)), decoder_("", decoder_counts_) {
    ASSERTMSG_(options.max_waiting_frames >= 1 && options.max_waiting_samples >= 2 &&
                   options.max_waiting_items >= 1,
               "the queues of a live source must hold a frame, two samples and an item");
    auto pushed = std::make_unique<PushedObservations>();
    pushed_ = pushed.get();
    observations_.emplace(std::move(pushed), options.observations, counts_);
  }

  void push(const mrpt::obs::CObservation::Ptr& observation) {
    if (observation == nullptr) return;
    {
      const std::lock_guard lock(mutex_);
      if (closed_ || error_) return;
      try {
        collect(observation);
      } catch (...) {
        error_ = std::current_exception();
      }
    }
    changed_.notify_all();
  }

  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
      if (!collector_ && !error_) {
        try {
          collector_.emplace(observations_->chooseCamera(), options_.observations, counts_);
          while (const auto kept = observations_->next()) collector_->add(kept, clock_());
        } catch (...) {
          error_ = std::current_exception();
        }
      }
    }
    changed_.notify_all();
  }

  std::shared_ptr<const StereoCamera> camera() {
    if (!decoder_.camera() && !first_) first_ = next();
    return decoder_.camera();
  }

  std::optional<LiveFrame> next() {
    if (auto first = std::exchange(first_, std::nullopt)) {
      if (!hasFrame()) return first;
      const std::lock_guard lock(mutex_);
      ++dropped_;
    }
    while (auto pending = waitForNewest()) {
      const double arrival_s = pending->arrival_s;
      auto frame = complete(std::move(*pending));
      publishCounts();
      if (frame) return LiveFrame{std::move(*frame), arrival_s};
      if (!decoder_.camera()) requirePatience(arrival_s);
    }
    return std::nullopt;
  }

  bool hasFrame() const {
    const std::lock_guard lock(mutex_);
    return isReady();
  }

  std::size_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

  std::string missing() const {
    const std::lock_guard lock(mutex_);
    if (collector_ || error_ || !has_come_) return "";
    try {
      (void)observations_->chooseCamera();
    } catch (const InputError& error) {
      return std::string("what has come ") + error.what();
    }
    return "";
  }

  LiveQueues queues() const {
    const std::lock_guard lock(mutex_);
    if (!collector_) return {};
    return {collector_->frames(), collector_->samples(), collector_->items()};
  }

  std::map<std::string, std::size_t> skipped() const {
    const std::lock_guard lock(mutex_);
    auto all = counts_;
    addCounts(published_decoder_counts_, all);
    return all;
  }

  Warnings warnings() const {
    const std::lock_guard lock(mutex_);
    Warnings all = collector_ ? collector_->warnings() : Warnings();
    all.insert(observations_->warnings().begin(), observations_->warnings().end());
    return all;
  }

  const std::optional<CalibrationReport>& calibration() const { return decoder_.report(); }

 private:
  /// Adds an observation to what waits, and drops what exceeds the options.
  void collect(const mrpt::obs::CObservation::Ptr& observation) {
    pushed_->push(observation);
    has_come_ = true;
    if (!collector_) {
      if (!observations_->readForCamera()) return;
      collector_.emplace(observations_->chooseCamera(), options_.observations, counts_);
    }
    while (const auto useful = observations_->next()) {
      collector_->add(useful, clock_());
      while (collector_->ready() > options_.max_waiting_frames) dropOldest();
      collector_->limit(options_.max_waiting_samples, options_.max_waiting_items);
    }
  }

  void dropOldest() {
    (void)collector_->take();
    ++dropped_;
  }

  [[nodiscard]] bool isReady() const {
    return collector_ && (collector_->isReady() || (closed_ && collector_->frames() > 0));
  }

  std::optional<PendingFrame> waitForNewest() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return closed_ || error_ || isReady(); });
    if (isReady()) {
      while (collector_->ready() > 1) dropOldest();
      if (auto frame = collector_->take()) return frame;
    }
    if (error_) std::rethrow_exception(error_);
    if (collector_) collector_->finish();
    return std::nullopt;
  }

  /// The frame with images and motion prior; nullopt if its images are unusable.
  std::optional<RecordedFrame> complete(PendingFrame pending) {
    if (!pending.pair) {
      RecordedFrame frame = FrameDecoder::frameOf(std::move(pending));
      const std::lock_guard lock(mutex_);
      frame.gnss = collector_->takeFixes(frame.time);
      return frame;
    }
    const auto images = decoder_.decode(*pending.pair);
    if (!images) return std::nullopt;
    std::optional<RecordedFrame> frame;
    try {
      if (!decoder_.camera()) {
        if (!hasFiniteCalibration(*pending.pair)) {
          ++decoder_counts_["bad_calibration"];
          return std::nullopt;
        }
        decoder_.calibrate(*pending.pair, *images);
      }
      decoder_.requireTwoCameras(*images);
      frame.emplace(decoder_.frameOf(std::move(pending), *images));
      decoder_.requireMatching(*frame->stereo);
    } catch (const InputError& error) {
      throw InputError(std::string(kName) + ": " + error.what());
    }
    return withMotion(std::move(*frame));
  }

  /// @throws InputError if no image could be used since the first one came
  void requirePatience(double arrival_s) {
    if (!first_unusable_s_) first_unusable_s_ = arrival_s;
    if (arrival_s - *first_unusable_s_ < kPatience_s) return;
    std::string text = "none of the images can be used";
    const char* separator = " (";
    for (const auto& [reason, count] : decoder_counts_) {
      text += separator + reason + " " + std::to_string(count);
      separator = ", ";
    }
    const bool is_uncalibrated = decoder_counts_.count("bad_calibration") > 0;
    throw InputError(std::string(kName) + ": " + text + "); " +
                     (is_uncalibrated
                          ? "give their calibration by --calibration FILE"
                          : "they are empty or broken: check camera, cable and driver"));
  }

  RecordedFrame withMotion(RecordedFrame frame) {
    const std::lock_guard lock(mutex_);
    collector_->extrapolateMotion(frame.time, options_.max_extrapolation_s);
    frame.stereo->motion_prior = collector_->motionBetween(last_time_, frame.time);
    frame.stereo->motion_prior.previous_frame = std::exchange(last_frame_, frame.index);
    collector_->discardMotionBefore(frame.time);
    frame.gnss = collector_->takeFixes(frame.time);
    last_time_ = frame.time;
    return frame;
  }

  void publishCounts() {
    const std::lock_guard lock(mutex_);
    published_decoder_counts_ = decoder_counts_;
  }

  const LiveSourceOptions options_;
  const MonotonicClock clock_;

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::map<std::string, std::size_t> counts_;  // guarded by mutex_, like the members below
  std::map<std::string, std::size_t> published_decoder_counts_;
  PushedObservations* pushed_ = nullptr;  ///< of observations_
  std::optional<UsefulObservations> observations_;
  std::optional<FrameCollector> collector_;  ///< once the camera is determined
  std::size_t dropped_ = 0;
  bool has_come_ = false;  ///< any observation
  bool closed_ = false;
  std::exception_ptr error_;

  std::map<std::string, std::size_t> decoder_counts_;  // the consumer's, like the members below
  FrameDecoder decoder_;
  std::optional<LiveFrame> first_;          ///< decoded by camera(), for next()
  std::optional<double> first_unusable_s_;  ///< arrival of the first image, before a usable one
  std::optional<Time> last_time_;           ///< of the latest frame
  std::optional<std::size_t> last_frame_;   ///< index of the same
};

LiveSourceOptions::LiveSourceOptions() { observations.read_ahead = 0; }

LiveSource::LiveSource(const LiveSourceOptions& options, MonotonicClock clock)
    : implementation_(std::make_unique<Implementation>(options, std::move(clock))) {}

LiveSource::~LiveSource() = default;

void LiveSource::push(const mrpt::obs::CObservation::Ptr& observation) {
  implementation_->push(observation);
}

void LiveSource::close() { implementation_->close(); }

std::shared_ptr<const StereoCamera> LiveSource::camera() { return implementation_->camera(); }

std::optional<LiveFrame> LiveSource::next() { return implementation_->next(); }

bool LiveSource::hasFrame() const { return implementation_->hasFrame(); }

std::size_t LiveSource::dropped() const { return implementation_->dropped(); }

std::string LiveSource::missing() const { return implementation_->missing(); }

LiveQueues LiveSource::queues() const { return implementation_->queues(); }

const std::optional<CalibrationReport>& LiveSource::calibration() const {
  return implementation_->calibration();
}

Warnings LiveSource::warnings() const { return implementation_->warnings(); }

std::map<std::string, std::size_t> LiveSource::skipped() const {
  return implementation_->skipped();
}

}  // namespace headway::io
