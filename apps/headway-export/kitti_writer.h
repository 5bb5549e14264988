#pragma once

#include <headway/core/stereo_frame.h>

#include <filesystem>
#include <fstream>
#include <vector>

namespace headway::exporting {

/// Writes stereo frames as a KITTI odometry sequence: `image_0/`, `image_1/` rectified grey,
/// `image_2/`, `image_3/` the same in colour where there is colour, `times.txt`, `calib.txt`, and
/// `poses.txt` where all frames have a truth. Frames are numbered from 0 as they are written.
/// Pictures are PNG: they keep every pixel.
class KittiWriter {
 public:
  /// @throws InputError if the folder cannot be made
  explicit KittiWriter(const std::filesystem::path& folder);

  /// @param right_colour  empty if the images are grey
  /// @throws InputError if something cannot be written
  void write(const StereoFrame& frame, const cv::Mat& right_colour);

  /// Writes calib.txt, and ends times.txt.
  void finish(const StereoCamera& camera);

  /// Writes poses.txt: left camera in the first left camera, one row for each frame written.
  void writeTruth(const std::vector<Pose>& T_map_robot, const StereoCamera& camera) const;

  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  void writeImage(const char* folder, const cv::Mat& image) const;

  std::filesystem::path folder_;
  std::ofstream times_;
  std::size_t size_ = 0;
};

}  // namespace headway::exporting
