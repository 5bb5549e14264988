#pragma once

#include <headway/io/rawlog_source.h>

#include <opencv2/core/mat.hpp>
#include <optional>

#include "finished_replay.h"

namespace headway::render_program {

/// Reads the left images of a replay's rawlog in order of time.
///
/// If the rawlog does not exist or has no images, this is noted once and all images are empty.
class RecordedImages {
 public:
  RecordedImages(const FinishedReplay& replay, std::size_t first_frame, const Note& note);

  /// The image of a frame, in colour if available; empty if there is none. Frames must be requested
  /// in ascending order.
  [[nodiscard]] cv::Mat at(const ReplayFrame& frame);

 private:
  std::optional<io::RawlogSource> source_;
  std::optional<RecordedFrame> ahead_;  ///< read ahead
};

}  // namespace headway::render_program
