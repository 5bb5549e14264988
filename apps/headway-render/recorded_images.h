#pragma once

#include <headway/io/rawlog_source.h>

#include <opencv2/core/mat.hpp>
#include <optional>

#include "finished_replay.h"

namespace headway::render_program {

/// The left images of a replay's rawlog, asked for in order of time.
///
/// A rawlog that is gone or has no images gives none, and says so once.
class RecordedImages {
 public:
  RecordedImages(const FinishedReplay& replay, std::size_t first_frame, const Note& note);

  /// The image of a frame, colour if there is any; empty where there is none. Frames must be asked
  /// for in ascending order.
  [[nodiscard]] cv::Mat at(const ReplayFrame& frame);

 private:
  std::optional<io::RawlogSource> source_;
  std::optional<RecordedFrame> ahead_;  ///< read but not asked for yet
};

}  // namespace headway::render_program
