// SPDX-License-Identifier: BSD-3-Clause
// A run: frames from a source, through the pipeline, to sinks.
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/core/worker_thread.h>
#include <headway/io/live_source.h>
#include <headway/io/rawlog_source.h>
#include <headway/map/shared_map.h>
#include <headway/pipeline/perception.h>

#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

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

/// A processed frame, with times of the session's clock.
struct FrameResult {
  RecordedFrame frame;
  pipeline::PerceptionUpdate update;
  std::size_t frames = 0;    ///< processed so far, with this one
  SourceReport source;       ///< after the frame was taken
  double arrival_s = 0.0;    ///< of the frame's second image, or when it was read [s]
  double start_s = 0.0;      ///< of Perception::process() [s]
  double end_s = 0.0;        ///< of the same [s]
  double delivered_s = 0.0;  ///< when all sinks had it; 0 in the sinks [s]
  double processor_s = 0.0;  ///< time of all threads during process() [s]
  std::string left_out;      ///< because of the load, such as "without pictures and grid"; or empty
  std::string load_change;   ///< one line if this has changed with the frame; or empty

  [[nodiscard]] double process_s() const { return end_s - start_s; }
  [[nodiscard]] double latency_s() const { return delivered_s - arrival_s; }
  /// Latency that the session, source and sinks add to the frame's own processing.
  [[nodiscard]] double overhead_s() const { return latency_s() - process_s(); }
};

/// Takes the results of a session: files, a page, a map for a planner. All calls come from the
/// session's thread.
class Sink {
 public:
  virtual ~Sink() = default;
  /// Within each frame, while objects are detected in it, for who needs that early: its pose, and
  /// a map with what is blocked now, all else as after the frame before. An exception ends the
  /// session.
  virtual void onLocal(Time /*time*/, const slam::SlamUpdate& /*camera*/,
                       const map::PerceptionMap& /*map*/) {}
  /// After each frame. An exception ends the session.
  virtual void onFrame(const FrameResult& result, pipeline::Perception& perception) = 0;
  /// No frame follows: the text of the exception that ended the session, or nullopt at the end of
  /// the source and after a stop. The source is closed, Perception::finish() follows. Must not
  /// throw.
  virtual void onEnd(const std::optional<std::string>& /*failure*/) {}
  /// After Perception::finish(), however the session ended and whatever other sinks have thrown.
  virtual void onComplete(pipeline::Perception& /*perception*/) {}
  /// Whether the sink is left out first while frames take longer than their interval.
  [[nodiscard]] virtual bool isExpendable() const { return false; }
};

/// Publishes the map after each frame for planners and viewers in other threads, and an empty one
/// if the session fails, so that they see kEmptyMap and stop.
class MapPublisher : public Sink {
 public:
  /// @param shared  must outlive this
  explicit MapPublisher(map::SharedMap& shared) : shared_(shared) {}
  void onFrame(const FrameResult& /*result*/, pipeline::Perception& perception) override {
    shared_.publish(perception.map());
  }
  void onEnd(const std::optional<std::string>& failure) override {
    if (failure) shared_.reset();
  }

 private:
  map::SharedMap& shared_;
};

/// What ends a session, and what it does apart from processing.
struct SessionOptions {
  StopCondition stop = neverStop;     ///< ends the session before its next frame
  bool end_at_fatal_finding = false;  ///< by an InputError with the finding's text
  /// Parameters without load: while frames take longer than their interval, the least useful work
  /// is left out step by step: expendable sinks, most ground scans, all of them, boxes beyond 30 m.
  /// nullopt: all work is always done.
  std::optional<pipeline::RuntimeParams> shed_load;
  std::function<void(RecordedFrame&)> prepare;  ///< changes a frame before process(); may be empty
  MonotonicClock clock = monotonicSeconds;
};

class LoadShedder;

/// A run: takes frames from a source, has them processed, and hands the results to sinks.
///
/// Synchronous: with a recording and without PerceptionParams::live(), the same input gives the
/// same results. With live sensors the newest frame is next.
///
///     RawlogFrames source("street.rawlog");
///     Perception perception(source.camera(), params);
///     Session(source, perception, {&files}).run();
class Session {
 public:
  /// @param source, perception, sinks  must outlive the session
  Session(Source& source, pipeline::Perception& perception, std::vector<Sink*> sinks = {},
          SessionOptions options = {});
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  /// Adds a sink behind the others.
  void add(Sink& sink) { sinks_.push_back(&sink); }

  /// Processes all frames and completes the sinks.
  ///
  /// @throws what ended the session (an InputError of a frame names source and frame), or else the
  ///         first exception of a sink's completion
  void run() {
    process();
    complete();
  }

  /// The next frame, for programs with a loop of their own, which end by complete(); nullopt at the
  /// end of the source and after a stop.
  ///
  /// @throws what source, perception or a sink throws; there is no next frame then
  std::optional<FrameResult> next();

  /// The first half of run(): all frames, and Perception::finish(). An exception is kept for
  /// complete().
  void process();
  /// The second half: Perception::finish(), if it is missing, and all sinks' onComplete().
  ///
  /// @throws as run()
  void complete();

 private:
  std::optional<FrameResult> processNext();
  void processFrame(FrameResult& result);
  void shedLoad(FrameResult& result);
  void deliver(FrameResult& result);
  void end(const std::optional<std::string>& failure);
  void finish();

  Source& source_;
  pipeline::Perception& perception_;
  std::vector<Sink*> sinks_;
  SessionOptions options_;
  std::unique_ptr<LoadShedder> shedder_;      ///< null: all work is done
  std::optional<Stamped<std::size_t>> last_;  ///< index of the last frame
  double expendable_s_ = 0.0;                 ///< of the expendable sinks with the last frame
  std::size_t frames_ = 0;
  bool has_ended_ = false;
  bool is_finished_ = false;
  std::exception_ptr failure_;  ///< the first one
};

}  // namespace headway::run
