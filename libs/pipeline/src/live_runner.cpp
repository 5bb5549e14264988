// SPDX-License-Identifier: BSD-3-Clause
#include <headway/pipeline/live_runner.h>

#include <utility>

namespace headway::pipeline {

LiveRunner::LiveRunner(LiveReader reader, Perception& perception, map::SharedMap& shared,
                       MonotonicClock clock)
    : LiveRunner(
          std::move(reader),
          [&perception](const RecordedFrame& frame) { return perception.process(frame); },
          [&perception, &shared] { shared.publish(perception.map()); },
          [&shared] { shared.reset(); }, std::move(clock)) {}

LiveRunner::LiveRunner(LiveReader reader, FrameStage stage, std::function<void()> publish,
                       std::function<void()> retract, MonotonicClock clock)
    : reader_(std::move(reader)),
      stage_(std::move(stage)),
      publish_(std::move(publish)),
      retract_(std::move(retract)),
      clock_(std::move(clock)) {}

std::optional<LiveUpdate> LiveRunner::next() {
  try {
    auto live = reader_();
    if (!live) return std::nullopt;
    LiveUpdate update;
    update.arrival_s = live->arrival_s;
    update.start_s = clock_();
    update.perception = stage_(live->frame);
    update.end_s = clock_();
    publish_();
    update.published_s = clock_();
    return update;
  } catch (...) {
    retract_();
    throw;
  }
}

}  // namespace headway::pipeline
