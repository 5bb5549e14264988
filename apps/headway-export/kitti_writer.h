#pragma once

#include <headway/core/stereo_frame.h>

#include <filesystem>
#include <fstream>
#include <vector>

namespace headway::exporting {

/// Writes stereo frames as a KITTI odometry sequence: `image_0/`, `image_1/` rectified grey,
/// `image_2/`, `image_3/` the same in colour if available, `times.txt`, `calib.txt`, and
/// `poses.txt` if all frames have a true pose. Frames are numbered from 0 in order of writing.
/// Images are PNG, thus lossless.
class KittiWriter {
 public:
  /// @throws InputError if the folder cannot be created
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
  std::ofstream times_;
  std::size_t size_ = 0;
};

}  // namespace headway::exporting
