// SPDX-License-Identifier: BSD-3-Clause
// A run: frames from a source, through the pipeline, to sinks.
#pragma once

#include <headway/map/shared_map.h>
#include <headway/pipeline/perception.h>
#include <headway/run/source.h>

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::run {

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
  std::string left_out;      ///< because of the load, such as "without page and grid"; or empty
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
