// SPDX-License-Identifier: BSD-3-Clause
// What several evaluations read of folders: images of the truth, the record and poses of a replay.
#include "evaluation_inputs.h"

#include <headway/core/error.h>
#include <headway/io/image_file.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <opencv2/imgproc.hpp>

namespace headway::eval {
namespace {

namespace fs = std::filesystem;

/// The image of a frame, read by `load`. @throws InputError
template <typename Load>
cv::Mat readImage(const fs::path& folder, std::size_t frame, const StereoCamera& camera,
                  Load load) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.png", frame);
  const fs::path path = folder / name;
  cv::Mat image = load(path.string());
  if (image.empty()) {
    throw InputError(path.string() + ": cannot be read; was headway-sim run with --depth --masks?");
  }
  if (image.size() != cv::Size(camera.width, camera.height)) {
    throw InputError(path.string() + ": the image size differs from the replay's rectified camera");
  }
  return image;
}

}  // namespace

cv::Mat readTrueDepth(const fs::path& folder, std::size_t frame, const StereoCamera& camera) {
  cv::Mat depth;
  readImage(folder / "depth", frame, camera, io::loadDepthImage)
      .convertTo(depth, CV_32F, 1.0 / 256.0);  // KITTI: 256 units a metre
  return depth;
}

cv::Mat readMovingMask(const fs::path& folder, std::size_t frame, const StereoCamera& camera) {
  constexpr int kSide = 5;  // widens by two pixels, the outline that a mask may miss
  cv::Mat moving = readImage(folder / "masks", frame, camera, io::loadGreyImage);
  cv::dilate(moving, moving, cv::getStructuringElement(cv::MORPH_RECT, {kSide, kSide}));
  return moving;
}

nlohmann::json replayRecord(const fs::path& replay) {
  const std::string path = (replay / "replay.json").string();
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened; is this the folder of a replay?");
  auto record = nlohmann::json::parse(file, nullptr, false);
  if (!record.is_object()) throw InputError(path + ": is not a JSON object");
  return record;
}

std::size_t firstFrame(const nlohmann::json& record) {
  const auto options = record.value("options", nlohmann::json::object());
  const auto from = options.find("from_index");
  return from != options.end() && from->is_number_unsigned() ? from->get<std::size_t>() : 0;
}

const Pose* poseAt(const std::vector<Stamped<Pose>>& trajectory, Time time) {
  const auto found = std::lower_bound(trajectory.begin(), trajectory.end(), time - kTimeTolerance_s,
                                      [](const auto& pose, Time t) { return pose.time < t; });
  return found == trajectory.end() || found->time > time + kTimeTolerance_s ? nullptr
                                                                            : &found->value;
}

}  // namespace headway::eval
