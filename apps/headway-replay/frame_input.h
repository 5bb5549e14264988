// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/live_source.h>
#include <headway/io/rawlog_source.h>
#include <headway/pipeline/frame_feed.h>

#include <atomic>
#include <map>
#include <memory>
#include <optional>
#include <string>

namespace headway::replay {

/// Frames of a run: a rawlog or live sensors.
class FrameInput {
 public:
  virtual ~FrameInput() = default;
  /// Name for messages.
  [[nodiscard]] virtual std::string name() const = 0;
  /// Null if there are only poses.
  [[nodiscard]] virtual std::shared_ptr<const StereoCamera> camera() = 0;
  [[nodiscard]] virtual const std::optional<io::CalibrationReport>& calibration() const = 0;
  /// Starts to read. The feed must end before the input.
  [[nodiscard]] virtual std::unique_ptr<pipeline::FrameFeed> makeFeed() = 0;
  /// Ratio read so far, 0 to 1; callable while the feed reads, as skippedNow().
  [[nodiscard]] virtual double progress() const = 0;
  /// Unused observations by reason; nullopt while another thread counts them.
  [[nodiscard]] virtual std::optional<std::map<std::string, std::size_t>> skippedNow() const = 0;
  /// The same once there is no feed any more.
  [[nodiscard]] virtual std::map<std::string, std::size_t> skipped() const = 0;
  /// Sensors with other clocks; callable when skippedNow() is not empty, and without a feed.
  [[nodiscard]] virtual Warnings warnings() const = 0;
  /// Whether frames are dropped that come too late.
  [[nodiscard]] virtual bool dropsLateFrames() const = 0;
  /// Reason of a premature end; nullopt otherwise.
  [[nodiscard]] virtual std::optional<std::string> truncation() const = 0;
};

/// A rawlog: every frame, or at a multiple of the recorded rate.
class RawlogInput : public FrameInput {
 public:
  /// @param realtime  multiple of the recorded rate; 0: every frame
  /// @throws InputError
  RawlogInput(const std::string& path, const io::RawlogSourceOptions& options, double realtime)
      : path_(path), realtime_(realtime), source_(path, options) {}

  [[nodiscard]] std::string name() const override { return path_; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return source_.camera(); }
  [[nodiscard]] const std::optional<io::CalibrationReport>& calibration() const override {
    return source_.calibration();
  }
  [[nodiscard]] std::unique_ptr<pipeline::FrameFeed> makeFeed() override {
    auto reader = [this] {
      auto frame = source_.next();
      progress_ = source_.progress();
      return frame;
    };
    return realtime_ > 0.0 ? pipeline::makeRealtimeFeed(reader, realtime_)
                           : pipeline::makeOfflineFeed(reader);
  }
  [[nodiscard]] double progress() const override { return progress_; }
  [[nodiscard]] bool dropsLateFrames() const override { return realtime_ > 0.0; }
  [[nodiscard]] std::optional<std::map<std::string, std::size_t>> skippedNow() const override {
    if (realtime_ > 0.0) return std::nullopt;
    return source_.skipped();
  }
  [[nodiscard]] std::map<std::string, std::size_t> skipped() const override {
    return source_.skipped();
  }
  [[nodiscard]] Warnings warnings() const override { return source_.warnings(); }
  [[nodiscard]] std::optional<std::string> truncation() const override {
    return source_.truncation();
  }

 private:
  std::string path_;
  double realtime_;
  io::RawlogSource source_;
  std::atomic<double> progress_{0.0};
};

/// Live observations, of which the newest frame is returned.
class LiveInput : public FrameInput {
 public:
  /// @param source  must outlive the input
  explicit LiveInput(io::LiveSource& source) : source_(source) {}

  [[nodiscard]] std::string name() const override { return "live sensors"; }
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() override { return source_.camera(); }
  [[nodiscard]] const std::optional<io::CalibrationReport>& calibration() const override {
    return source_.calibration();
  }
  [[nodiscard]] std::unique_ptr<pipeline::FrameFeed> makeFeed() override {
    return std::make_unique<Feed>(*this);
  }
  [[nodiscard]] double progress() const override { return 0.0; }
  [[nodiscard]] bool dropsLateFrames() const override { return true; }
  [[nodiscard]] std::optional<std::map<std::string, std::size_t>> skippedNow() const override {
    return source_.skipped();
  }
  [[nodiscard]] std::map<std::string, std::size_t> skipped() const override {
    return source_.skipped();
  }
  [[nodiscard]] Warnings warnings() const override { return source_.warnings(); }
  [[nodiscard]] std::optional<std::string> truncation() const override { return std::nullopt; }

  /// Arrival of the newest frame returned, by monotonicSeconds().
  [[nodiscard]] double arrival_s() const { return arrival_s_; }

 private:
  class Feed : public pipeline::FrameFeed {
   public:
    explicit Feed(LiveInput& input) : input_(input) {}
    std::optional<RecordedFrame> next() override {
      auto live = input_.source_.next();
      if (!live) return std::nullopt;
      input_.arrival_s_ = live->arrival_s;
      return std::move(live->frame);
    }
    [[nodiscard]] std::size_t dropped() const override { return input_.source_.dropped(); }

   private:
    LiveInput& input_;
  };

  io::LiveSource& source_;
  double arrival_s_ = 0.0;
};

}  // namespace headway::replay
