// SPDX-License-Identifier: BSD-3-Clause
#include <headway/io/dataset.h>

#include "depth_calibration.h"
#include "image_files.h"
#include "paired_folders.h"

namespace headway::io {
namespace {

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

std::unique_ptr<Dataset> openDepthFolders(const std::string& left_folder,
                                          const std::string& depth_folder,
                                          const std::string& calibration) {
  return std::make_unique<DepthFolders>(left_folder, depth_folder, calibration);
}

}  // namespace headway::io
