#include <headway/core/error.h>
#include <headway/io/dataset.h>

#include <filesystem>

#include "depth_calibration.h"
#include "image_files.h"

namespace headway::io {
namespace {

class DepthFolders : public Dataset {
 public:
  DepthFolders(const std::string& left_folder, const std::string& depth_folder,
               const std::string& calibration)
      : lefts_(imagesIn(left_folder)), depths_(imagesIn(depth_folder)) {
    requirePaired(left_folder, lefts_, depth_folder, depths_);
    const auto file = readDepthCalibration(calibration);
    camera_ = file.camera;
    const auto folder = std::filesystem::path(calibration).parent_path();
    times_ = frameTimes(file.times, file.frame_rate, folder.string(), lefts_.size());
  }

  std::size_t size() const override { return lefts_.size(); }

  DatasetFrame frame(std::size_t index) const override {
    DatasetFrame frame;
    frame.time = times_.at(index);
    frame.left = requireImageOf(lefts_.at(index), camera_.color);
    frame.depth = requireDepthImageOf(depths_.at(index), camera_.depth);
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return leftAlone(camera_); }
  std::optional<RawDepthCamera> depthCamera() const override { return camera_; }

 private:
  RawDepthCamera camera_;
  std::vector<std::string> lefts_;
  std::vector<std::string> depths_;
  std::vector<Time> times_;
};

}  // namespace

std::unique_ptr<Dataset> openDepthFolders(const std::string& left_folder,
                                          const std::string& depth_folder,
                                          const std::string& calibration) {
  return std::make_unique<DepthFolders>(left_folder, depth_folder, calibration);
}

}  // namespace headway::io
