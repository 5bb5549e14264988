// SPDX-License-Identifier: BSD-3-Clause
// Two folders of images as a recording: a stereo pair, or images with depth.
#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "image_files.h"

namespace headway::io {
namespace {

/// Requires two folders of the same number of images, at least one.
void requirePaired(const std::string& left_folder, const std::vector<std::string>& lefts,
                   const std::string& other_folder, const std::vector<std::string>& others) {
  if (lefts.size() != others.size()) {
    throw InputError(left_folder + " contains " + std::to_string(lefts.size()) + " images and " +
                     other_folder + " " + std::to_string(others.size()) +
                     "; both folders must contain the same number");
  }
  if (lefts.empty()) throw InputError(left_folder + ": contains no images");
}

/// Times of the frames of image folders.
///
/// @param times_file  name of a file in `folder` with one time per line; empty: by the rate
/// @param rate_hz     0: 10 Hz
/// @throws InputError if the file has too few times
std::vector<Time> frameTimes(const std::string& times_file, double rate_hz,
                             const std::string& folder, std::size_t frames) {
  if (!times_file.empty()) {
    const auto path = std::filesystem::path(folder) / times_file;
    auto times = readTimes(path.string());
    if (times.size() < frames) {
      throw InputError(path.string() + ": has " + std::to_string(times.size()) + " times for " +
                       std::to_string(frames) + " images");
    }
    return times;
  }
  const double rate = rate_hz > 0.0 ? rate_hz : 10.0;
  std::vector<Time> times;
  for (std::size_t i = 0; i < frames; ++i) times.push_back(static_cast<double>(i) / rate);
  return times;
}

/// Two folders with as many images each: the left ones, and the right or depth ones.
class PairedFolders : public Dataset {
 public:
  [[nodiscard]] std::size_t size() const override { return lefts_.size(); }

 protected:
  /// @throws InputError if the numbers of images differ, or there is none
  PairedFolders(const std::string& left_folder, const std::string& other_folder)
      : lefts_(imagesIn(left_folder)), others_(imagesIn(other_folder)) {
    requirePaired(left_folder, lefts_, other_folder, others_);
  }

  /// Takes the times of what a calibration, `file` read from `path`, says of them.
  template <typename CalibrationFile>
  void setTimes(const CalibrationFile& file, const std::string& path) {
    const auto folder = std::filesystem::path(path).parent_path();
    times_ = frameTimes(file.times, file.frame_rate, folder.string(), lefts_.size());
  }

  [[nodiscard]] const std::string& left(std::size_t index) const { return lefts_.at(index); }
  [[nodiscard]] const std::string& other(std::size_t index) const { return others_.at(index); }
  [[nodiscard]] Time time(std::size_t index) const { return times_.at(index); }

 private:
  std::vector<std::string> lefts_;
  std::vector<std::string> others_;
  std::vector<Time> times_;
};

/// Width and height of an image.
std::array<int, 2> sizeOf(const std::string& path) {
  const cv::Mat image = requireImage(path);
  return {image.cols, image.rows};
}

class ImageFolders : public PairedFolders {
 public:
  ImageFolders(const std::string& left_folder, const std::string& right_folder,
               const std::string& calibration)
      : PairedFolders(left_folder, right_folder) {
    const auto file = readStereoCalibration(calibration, sizeOf(left(0)));
    camera_ = file.camera;
    requireSizeOfImages(calibration);
    setTimes(file, calibration);
  }

  DatasetFrame frame(std::size_t index) const override {
    DatasetFrame frame;
    frame.time = time(index);
    frame.left = requireImage(left(index));
    frame.right = requireImage(other(index));
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return camera_; }

 private:
  void requireSizeOfImages(const std::string& calibration) const {
    const auto [width, height] = sizeOf(left(0));
    if (camera_.left.width == width && camera_.left.height == height) return;
    throw InputError(calibration + ": is of images of " + std::to_string(camera_.left.width) + "x" +
                     std::to_string(camera_.left.height) + " px, but " + left(0) + " has " +
                     std::to_string(width) + "x" + std::to_string(height));
  }

  RawStereoCamera camera_;
};

class DepthFolders : public PairedFolders {
 public:
  DepthFolders(const std::string& left_folder, const std::string& depth_folder,
               const std::string& calibration)
      : PairedFolders(left_folder, depth_folder) {
    const auto file = readDepthCalibration(calibration);
    camera_ = file.camera;
    setTimes(file, calibration);
  }

  DatasetFrame frame(std::size_t index) const override {
    DatasetFrame frame;
    frame.time = time(index);
    frame.left = requireImageOf(left(index), camera_.color);
    frame.depth = requireDepthImageOf(other(index), camera_.depth);
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return leftAlone(camera_); }
  std::optional<RawDepthCamera> depthCamera() const override { return camera_; }

 private:
  RawDepthCamera camera_;
};

}  // namespace

std::unique_ptr<Dataset> openImageFolders(const std::string& left_folder,
                                          const std::string& right_folder,
                                          const std::string& calibration) {
  return std::make_unique<ImageFolders>(left_folder, right_folder, calibration);
}

std::unique_ptr<Dataset> openDepthFolders(const std::string& left_folder,
                                          const std::string& depth_folder,
                                          const std::string& calibration) {
  return std::make_unique<DepthFolders>(left_folder, depth_folder, calibration);
}

}  // namespace headway::io
