// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/report/replay_frames.h>

#include <memory>
#include <opencv2/core/mat.hpp>

namespace headway::report {

/// Reads the left images of a replay's rawlog in order of time.
///
/// If the rawlog does not exist or has no images, this is noted once and all images are empty.
class RecordedImages {
 public:
  RecordedImages(const ReplayInput& input, std::size_t first_frame, const Note& note);
  ~RecordedImages();
  RecordedImages(const RecordedImages&) = delete;
  RecordedImages& operator=(const RecordedImages&) = delete;

  /// The image of a frame, in colour if available; empty if there is none. Frames must be requested
  /// in ascending order.
  [[nodiscard]] cv::Mat at(std::size_t frame);

 private:
  class Reader;
  std::unique_ptr<Reader> reader_;  ///< null without images
};

}  // namespace headway::report
