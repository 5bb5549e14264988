// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/live_frame.h>
#include <headway/map/shared_map.h>
#include <headway/pipeline/perception.h>

#include <functional>
#include <optional>

namespace headway::pipeline {

/// Waits for the newest frame of live sensors; nullopt at the end. May throw.
using LiveReader = std::function<std::optional<LiveFrame>()>;

/// Processes one frame, as Perception::process().
using FrameStage = std::function<PerceptionUpdate(const RecordedFrame&)>;

/// Result of one live frame with its times by the runner's clock.
struct LiveUpdate {
  PerceptionUpdate perception;
  double arrival_s = 0.0;    ///< arrival of the frame's second image [s]
  double start_s = 0.0;      ///< start of process() [s]
  double end_s = 0.0;        ///< end of process() [s]
  double published_s = 0.0;  ///< map and tracks are available to other threads [s]

  [[nodiscard]] double latency_s() const { return published_s - arrival_s; }
  [[nodiscard]] double process_s() const { return end_s - start_s; }
  /// Latency that the runner and its reader add to the frame's own processing.
  [[nodiscard]] double overhead_s() const { return latency_s() - process_s(); }
};

/// Runs the pipeline on live frames in the calling thread and publishes the map after each.
///
/// The reader selects the frame, so with io::LiveSource the newest frame is processed next. If
/// perception or the reader fails, an empty map is published before the exception is passed on, so
/// that planners see kEmptyMap and stop.
///
///     LiveRunner runner([&] { return source.next(); }, perception, shared);
///     while (auto update = runner.next()) report(update->perception.objects.tracks);
class LiveRunner {
 public:
  /// @param perception  with PerceptionParams::live(); must outlive the runner
  /// @param shared      receives the map; must outlive the runner
  LiveRunner(LiveReader reader, Perception& perception, map::SharedMap& shared,
             MonotonicClock clock = monotonicSeconds);

  /// With another stage, such as one for tests.
  ///
  /// @param publish  makes the results available after each frame
  /// @param retract  called if reader or stage throws
  LiveRunner(LiveReader reader, FrameStage stage, std::function<void()> publish,
             std::function<void()> retract, MonotonicClock clock);

  /// Processes and publishes the next frame; nullopt at the end of the input.
  ///
  /// @throws what the reader or the stage throws
  [[nodiscard]] std::optional<LiveUpdate> next();

 private:
  LiveReader reader_;
  FrameStage stage_;
  std::function<void()> publish_;
  std::function<void()> retract_;
  MonotonicClock clock_;
};

}  // namespace headway::pipeline
