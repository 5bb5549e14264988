// SPDX-License-Identifier: BSD-3-Clause
// Where the frames of a run come from.
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/core/worker_thread.h>
#include <headway/io/live_source.h>
#include <headway/io/rawlog_source.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

namespace headway::run {

/// What a source says about itself so far.
struct SourceReport {
  std::size_t dropped = 0;  ///< frames, because the pipeline was busy
  double progress = 0.0;    ///< ratio read, 0 to 1
  /// Unused observations by reason; nullopt while another thread counts them, which close() ends.
  std::optional<std::map<std::string, std::size_t>> skipped;
  Warnings warnings;                      ///< sensors with other clocks; empty without `skipped`
  std::optional<std::string> truncation;  ///< reason of a premature end
};

/// Where the frames of a run come from: a recording, live sensors, a simulator.
class Source {
 public:
  virtual ~Source() = default;
  /// Name for messages.
  [[nodiscard]] virtual std::string name() const = 0;
  /// Camera of all stereo frames; null if there are only poses. May wait for the first images.
  [[nodiscard]] virtual std::shared_ptr<const StereoCamera> camera() = 0;
  /// Waits for the next frame; nullopt at the end, or if `stop` ended the wait. May throw.
  [[nodiscard]] virtual std::optional<LiveFrame> next(const StopCondition& stop) = 0;
  /// Ends reading in the background. No frame is asked for afterwards.
  virtual void close() {}
  [[nodiscard]] virtual SourceReport report() const = 0;
  /// Whether frames are dropped that come too late.
  [[nodiscard]] virtual bool dropsLateFrames() const { return false; }
  /// Consistency of images and calibration; nullopt if unknown.
  [[nodiscard]] virtual std::optional<io::CalibrationReport> calibration() const { return {}; }
};

/// A rawlog: every frame, read on demand.
class RawlogFrames : public Source {
 public:
  /// @throws InputError
  explicit RawlogFrames(const std::string& path, const io::RawlogSourceOptions& options = {})
      : path_(path), source_(path, options) {}

  [[nodiscard]] std::string name() const override { return path_; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return source_.camera(); }
  [[nodiscard]] std::optional<LiveFrame> next(const StopCondition& /*stop*/) override {
    auto frame = source_.next();
    if (!frame) return std::nullopt;
    return LiveFrame{std::move(*frame), monotonicSeconds()};
  }
  [[nodiscard]] SourceReport report() const override {
    return {0, source_.progress(), source_.skipped(), source_.warnings(), source_.truncation()};
  }
  [[nodiscard]] std::optional<io::CalibrationReport> calibration() const override {
    return source_.calibration();
  }

 private:
  std::string path_;
  io::RawlogSource source_;
};

/// Live sensors, of which the newest frame is next. io::LiveSource::close() ends the wait for it.
class SensorFrames : public Source {
 public:
  /// @param source  must outlive this
  explicit SensorFrames(io::LiveSource& source) : source_(source) {}

  [[nodiscard]] std::string name() const override { return "live sensors"; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return source_.camera(); }
  [[nodiscard]] std::optional<LiveFrame> next(const StopCondition& /*stop*/) override {
    return source_.next();
  }
  [[nodiscard]] SourceReport report() const override {
    return {source_.dropped(), 0.0, source_.skipped(), source_.warnings(), std::nullopt};
  }
  [[nodiscard]] bool dropsLateFrames() const override { return true; }
  [[nodiscard]] std::optional<io::CalibrationReport> calibration() const override {
    return source_.calibration();
  }

 private:
  io::LiveSource& source_;
};

/// Frames of another source at the rate of a live camera: a thread reads them at `factor` times the
/// recorded rate into a queue of `capacity`; if the queue is full, its oldest frame is dropped and
/// counted, so that with a capacity of 1 the newest frame is always next. From the first next() to
/// close() the other source is used in that thread only; what it throws follows its frames. A pause
/// of the recording lasts at most 5 s of it.
///
/// @param source    not null
/// @param factor    > 0; 1 is the recorded rate
/// @param capacity  >= 1
[[nodiscard]] std::unique_ptr<Source> inRealtime(std::unique_ptr<Source> source, double factor,
                                                 std::size_t capacity = 1);

}  // namespace headway::run
