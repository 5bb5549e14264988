// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/output_file.h>
#include <headway/core/stereo_frame.h>

#include <filesystem>
#include <vector>

namespace headway::exporting {

/// Whether a file is one that KittiWriter writes, by its path in the folder.
[[nodiscard]] bool isExported(const std::filesystem::path& file);

/// Writes stereo frames as a KITTI odometry sequence: `image_0/`, `image_1/` rectified grey,
/// `image_2/`, `image_3/` the same in colour if available, `times.txt`, `calib.txt`, and
/// `poses.txt` if all frames have a true pose. Frames are numbered from 0 in order of writing.
/// Images are PNG, thus lossless.
class KittiWriter {
 public:
  /// @throws InputError if the folder cannot be written
  explicit KittiWriter(const std::filesystem::path& folder);

  /// @param right_colour  empty if the images are grey
  /// @throws InputError on a write error
  void write(const StereoFrame& frame, const cv::Mat& right_colour);

  /// Writes calib.txt and closes times.txt.
  void finish(const StereoCamera& camera);

  /// Writes poses.txt: left camera in the first left camera, one row per frame.
  void writeTruth(const std::vector<Pose>& T_map_robot, const StereoCamera& camera) const;

  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void writeImage(const char* folder, const cv::Mat& image) const;

  std::filesystem::path folder_;
  GrowingFile times_;
  std::size_t size_ = 0;
};

}  // namespace headway::exporting
