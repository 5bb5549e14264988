// SPDX-License-Identifier: BSD-3-Clause
// The interactive page of a replay.
#pragma once

#include <headway/core/pose.h>
#include <headway/report/replay_frames.h>

#include <cstdint>
#include <filesystem>
#include <map>
#include <opencv2/core/mat.hpp>
#include <string>
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
  std::size_t bytes_ = 0;
  JpegByFrame jpegs_;
};

/// What the page of a replay shows beside the files in the replay's folder.
struct ReplayPageOptions {
  std::filesystem::path truth;   ///< folder with trajectory.tum and objects.csv; empty: no truth
  std::filesystem::path output;  ///< empty: replay.html in the replay's folder
  std::string title;             ///< empty: the name of the recording, or of the folder
  std::vector<Stamped<Pose>> keyframes;  ///< robot in map
  JpegByFrame images;                    ///< of the left camera
};

/// Writes a finished replay as one self-contained HTML page with a 3D view and a timeline.
///
/// Shows the map (`map_dense.ply`, `map_points.ply`, `map_grid.yaml`), the robot's path and images,
/// boxes, their trails and predictions, and the truth. Of long runs at most 2000 frames are shown,
/// of large maps at most 450,000 points. Missing files are left out. The page loads nothing from
/// elsewhere, and its Content-Security-Policy allows no scripts but its own. The same folder and
/// options give the same bytes.
///
///     report::writeReplayPage(outdir, {}, note);
///
/// @param note  receives what is missing
/// @return the page's path
/// @throws InputError if there is no trajectory, a file is malformed, or the page cannot be written
std::filesystem::path writeReplayPage(const std::filesystem::path& folder,
                                      const ReplayPageOptions& options, const Note& note);

}  // namespace headway::report
