// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/recorded_frame.h>

#include <functional>
#include <memory>
#include <optional>

namespace headway::pipeline {

/// Returns the next frame, or nullopt at the end. May throw.
using FrameReader = std::function<std::optional<RecordedFrame>()>;

/// Source of frames for the pipeline: every frame, or in real time with dropped frames.
class FrameFeed {
 public:
  virtual ~FrameFeed() = default;
  /// The next frame; nullopt at the end. Rethrows exceptions of the reader.
  [[nodiscard]] virtual std::optional<RecordedFrame> next() = 0;
  /// Number of frames dropped because the pipeline was busy.
  [[nodiscard]] virtual std::size_t dropped() const = 0;
};

/// Every frame, read on demand: offline and deterministic.
[[nodiscard]] std::unique_ptr<FrameFeed> makeOfflineFeed(FrameReader reader);

/// Frames at the rate of a live camera: a separate thread reads them at `factor` times the recorded
/// rate into a queue of `capacity`; if the queue is full, its oldest frame is dropped and counted,
/// so that with a capacity of 1 the newest frame is always returned next. The reader is called in
/// that thread only. A pause of the recording lasts at most 5 s of it; requestStop() ends the feed.
///
/// @param factor    > 0; 1 is the recorded rate
/// @param capacity  >= 1
[[nodiscard]] std::unique_ptr<FrameFeed> makeRealtimeFeed(FrameReader reader, double factor,
                                                          std::size_t capacity = 1);

}  // namespace headway::pipeline
