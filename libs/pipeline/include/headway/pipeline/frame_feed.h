#pragma once

#include <headway/core/recorded_frame.h>

#include <functional>
#include <memory>
#include <optional>

namespace headway::pipeline {

/// Where frames come from: the next one, or nullopt at the end. May throw.
using FrameReader = std::function<std::optional<RecordedFrame>()>;

/// Hands frames on: every one of them, or only those that are not late.
class FrameFeed {
 public:
  virtual ~FrameFeed() = default;
  /// The next frame; nullopt at the end. Rethrows what the reader threw.
  [[nodiscard]] virtual std::optional<RecordedFrame> next() = 0;
  /// Frames read and not handed on, because the pipeline was busy.
  [[nodiscard]] virtual std::size_t dropped() const = 0;
};

/// Every frame, read when it is asked for: the offline way, deterministic.
[[nodiscard]] std::unique_ptr<FrameFeed> makeOfflineFeed(FrameReader reader);

/// Frames as a live camera would give them: a thread of its own reads them at `factor` times the
/// recorded rate into a queue of `capacity`; a frame that finds the queue full pushes the oldest
/// out, and that is counted. The reader runs in that thread alone.
///
/// @param factor    > 0; 1 is the recorded rate
/// @param capacity  >= 1
[[nodiscard]] std::unique_ptr<FrameFeed> makeRealtimeFeed(FrameReader reader, double factor,
                                                          std::size_t capacity = 2);

}  // namespace headway::pipeline
