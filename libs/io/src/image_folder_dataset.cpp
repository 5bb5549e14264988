#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>

#include <filesystem>

#include "image_files.h"
#include "yaml_file.h"

namespace headway::io {
namespace {

constexpr double kDefaultFrameRate = 10.0;  // [Hz]

std::vector<Time> frameTimes(const std::string& calibration, std::size_t frames) {
  const YamlFile file(calibration);
  if (file.has("times")) {
    const auto path = std::filesystem::path(calibration).parent_path() / file.word("times");
    auto times = readTimes(path.string());
    if (times.size() < frames) {
      throw InputError(path.string() + ": has " + std::to_string(times.size()) + " times for " +
                       std::to_string(frames) + " images");
    }
    return times;
  }
  const double rate = file.has("frame_rate_hz") ? file.number("frame_rate_hz") : kDefaultFrameRate;
  if (!(rate > 0.0)) file.fail("key 'frame_rate_hz' must be positive");
  std::vector<Time> times;
  for (std::size_t i = 0; i < frames; ++i) times.push_back(static_cast<double>(i) / rate);
  return times;
}

class ImageFolders : public Dataset {
 public:
  ImageFolders(const std::string& left_folder, const std::string& right_folder,
               const std::string& calibration)
      : camera_(readRawCalibration(calibration, {"times", "frame_rate_hz"})),
        lefts_(imagesIn(left_folder)),
        rights_(imagesIn(right_folder)) {
    if (lefts_.size() != rights_.size()) {
      throw InputError(left_folder + " contains " + std::to_string(lefts_.size()) + " images and " +
                       right_folder + " " + std::to_string(rights_.size()) +
                       "; both folders must contain the same number");
    }
    if (lefts_.empty()) throw InputError(left_folder + ": contains no images");
    times_ = frameTimes(calibration, lefts_.size());
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
