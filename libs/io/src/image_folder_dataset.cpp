#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>

#include <array>
#include <filesystem>

#include "image_files.h"

namespace headway::io {
namespace {

/// Width and height of an image.
std::array<int, 2> sizeOf(const std::string& path) {
  const cv::Mat image = requireImage(path);
  return {image.cols, image.rows};
}

class ImageFolders : public Dataset {
 public:
  ImageFolders(const std::string& left_folder, const std::string& right_folder,
               const std::string& calibration)
      : lefts_(imagesIn(left_folder)), rights_(imagesIn(right_folder)) {
    requirePaired(left_folder, lefts_, right_folder, rights_);
    const auto file = readStereoCalibration(calibration, sizeOf(lefts_.front()));
    camera_ = file.camera;
    requireSizeOfImages(calibration);
    const auto folder = std::filesystem::path(calibration).parent_path();
    times_ = frameTimes(file.times, file.frame_rate, folder.string(), lefts_.size());
  }

  std::size_t size() const override { return lefts_.size(); }

  DatasetFrame frame(std::size_t index) const override {
    DatasetFrame frame;
    frame.time = times_.at(index);
    frame.left = requireImage(lefts_.at(index));
    frame.right = requireImage(rights_.at(index));
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return camera_; }

 private:
  void requireSizeOfImages(const std::string& calibration) const {
    const auto [width, height] = sizeOf(lefts_.front());
    if (camera_.left.width == width && camera_.left.height == height) return;
    throw InputError(calibration + ": is of images of " + std::to_string(camera_.left.width) + "x" +
                     std::to_string(camera_.left.height) + " px, but " + lefts_.front() + " has " +
                     std::to_string(width) + "x" + std::to_string(height));
  }

  RawStereoCamera camera_;
  std::vector<std::string> lefts_;
  std::vector<std::string> rights_;
  std::vector<Time> times_;
};

}  // namespace

std::unique_ptr<Dataset> openImageFolders(const std::string& left_folder,
                                          const std::string& right_folder,
                                          const std::string& calibration) {
  return std::make_unique<ImageFolders>(left_folder, right_folder, calibration);
}

}  // namespace headway::io
