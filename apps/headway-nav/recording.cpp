#include "recording.h"

#include <headway/core/error.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

namespace headway::app {
namespace {

constexpr double kPicturesPerSecond = 20.0;

void writePicture(const std::string& path, const cv::Mat& picture) {
  if (!cv::imwrite(path, picture)) {
    throw InputError(path + ": cannot be written; is the disk full?");
  }
}

double endOf(const std::vector<TrialRecord>& records) {
  double end_s = 0.0;
  for (const auto& record : records) end_s = std::max(end_s, record.moments.back().time_s);
  return end_s;
}

}  // namespace

std::string recordingName(const std::string& folder, int seed) {
  return folder + cv::format("/trial_%04d", seed);
}

std::vector<std::string> writeRecording(const std::vector<TrialRecord>& records,
                                        const RobotParams& robot, int seed,
                                        const std::string& folder) {
  std::error_code failed;
  std::filesystem::create_directories(folder, failed);
  if (failed) throw InputError(folder + ": cannot be created (" + failed.message() + ")");
  const std::string name = recordingName(folder, seed);
  writePicture(name + ".png", drawWhole(records, robot));

  const int count = static_cast<int>((endOf(records) + 1.0) * kPicturesPerSecond);
  const cv::Size size = drawMoment(records, robot, 0.0).size();
  cv::VideoWriter video(name + ".mp4", cv::VideoWriter::fourcc('m', 'p', '4', 'v'),
                        kPicturesPerSecond, size);
  const std::string pictures = name + "_pictures";
  if (!video.isOpened()) std::filesystem::create_directories(pictures);
  for (int i = 0; i < count; ++i) {
    const cv::Mat picture = drawMoment(records, robot, i / kPicturesPerSecond);
    if (video.isOpened()) {
      video.write(picture);
    } else {
      writePicture(pictures + cv::format("/%06d.png", i), picture);
    }
  }
  return {name + ".png", video.isOpened() ? name + ".mp4" : pictures};
}

}  // namespace headway::app
