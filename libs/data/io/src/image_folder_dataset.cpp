// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>

#include <array>

#include "image_files.h"
#include "paired_folders.h"

namespace headway::io {
namespace {

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

}  // namespace

std::unique_ptr<Dataset> openImageFolders(const std::string& left_folder,
                                          const std::string& right_folder,
                                          const std::string& calibration) {
  return std::make_unique<ImageFolders>(left_folder, right_folder, calibration);
}

}  // namespace headway::io
