// SPDX-License-Identifier: BSD-3-Clause
#include "recording.h"

#include <headway/core/error.h>
#include <headway/program/picture_files.h>

#include <algorithm>
#include <filesystem>
#include <opencv2/core.hpp>

namespace headway::app {
namespace {

constexpr double kPicturesPerSecond = 20.0;

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
  program::writePicture(name + ".png", drawWhole(records, robot));

  const int count = static_cast<int>((endOf(records) + 1.0) * kPicturesPerSecond);
  const cv::Size size = drawMoment(records, robot, 0.0).size();
  program::VideoOutput video(name + ".mp4", kPicturesPerSecond, size, true,
                             [](const std::string&) {});  // the returned path shows it
  for (int i = 0; i < count; ++i) video.add(drawMoment(records, robot, i / kPicturesPerSecond));
  video.finish();
  return {name + ".png", video.path()};
}

}  // namespace headway::app
