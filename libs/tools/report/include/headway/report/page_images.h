// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core/mat.hpp>
#include <vector>

namespace headway::report {

/// JPEG files by the index of their frame.
using JpegByFrame = std::map<std::size_t, std::vector<std::uint8_t>>;

/// Keeps small images of a recording of any length, evenly spaced, in bounded memory.
///
///     PageImages images;
///     for (const auto& frame : recording) images.add(frame.index, frame.stereo->left);
///     options.images = images.jpegs();
class PageImages {
 public:
  /// Keeps every image at first, and every second, fourth, ... one of a long recording. Frames are
  /// added in ascending order.
  ///
  /// @param image  grey or BGR; if empty, the frame has none
  void add(std::size_t frame, const cv::Mat& image);

  [[nodiscard]] const JpegByFrame& jpegs() const { return jpegs_; }

 private:
  std::size_t added_ = 0;
  std::size_t step_ = 1;
  JpegByFrame jpegs_;
};

}  // namespace headway::report
