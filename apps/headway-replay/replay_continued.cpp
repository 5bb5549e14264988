// SPDX-License-Identifier: BSD-3-Clause
// The parts of Replay that continue a killed run.
#include <headway/core/error.h>

#include <algorithm>

#include "replay.h"

namespace headway::replay {

void Replay::continueRun(const Continuation& continuation) {
  const ProgramState& state = continuation.state;
  summary_ = state.summary;
  summary_.continued_after.push_back(continuation.extent.last_frame);
  dropped_before_ = summary_.frames_dropped_late;
  next_frame_ = state.next_frame;
  seen_tracks_ = state.seen_tracks;
  gnss_ = state.gnss;
  last_frame_ = continuation.extent.last_frame;
  has_lost_image_ = std::filesystem::exists(folder_.path() / "lost.jpg");
  snapshots_.continueRun(onlinePath(folder_.path(), state.rows.at("trajectory_online.tum")));
}

bool Replay::isRepeated(RecordedFrame& frame) {
  const auto& extent = options_.continuation->extent;
  if (source_->isLive()) {
    frame.index += extent.last_frame + 1;
    if (frame.stereo) frame.stereo->index = frame.index;
  }
  if (frame.index > extent.last_frame) return false;
  if (frame.index == extent.last_frame && frame.time != extent.last_time) {
    throw InputError(source_->name() + ": is not the recording of the run to continue: frame " +
                     std::to_string(frame.index) + " has another time");
  }
  (void)processed(frame);
  return true;
}

/// The part of a recording that was processed before a kill is only passed over, and its skipped
/// observations are counted again; live ones are not.
void Replay::addEarlierSkipped(Summary& summary) const {
  if (options_.continuation == nullptr) return;
  for (const auto& [reason, count] : options_.continuation->state.summary.observations_skipped) {
    auto& skipped = summary.observations_skipped[reason];
    skipped = source_->isLive() ? skipped + count : std::max(skipped, count);
  }
}

}  // namespace headway::replay
