// SPDX-License-Identifier: BSD-3-Clause
#include "check_model.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/detect/network_detector.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "check_frame.h"

namespace headway::replay {
namespace {

constexpr int kTimedRuns = 5;

StereoFrame bundledFrame() {
  const std::vector<unsigned char> bytes(std::begin(kCheckFrame), std::end(kCheckFrame));
  auto camera = std::make_shared<StereoCamera>();
  StereoFrame frame;
  frame.left_colour = cv::imdecode(bytes, cv::IMREAD_COLOR);
  cv::cvtColor(frame.left_colour, frame.left, cv::COLOR_BGR2GRAY);
  camera->width = frame.left.cols;
  camera->height = frame.left.rows;
  frame.camera = camera;
  return frame;
}

double bestTime(detect::Detector& detector, const StereoFrame& frame) {
  double best_ms = 1e9;
  for (int run = 0; run < kTimedRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    (void)detector.detect(frame);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    best_ms = std::min(best_ms, elapsed.count());
  }
  return best_ms;
}

}  // namespace

bool checkModel(const std::string& file, detect::NetworkParams params) {
  if (file.empty()) return false;
  params.model = file;
  detect::NetworkDetector detector(params);
  const auto frame = bundledFrame();
  const auto found = detector.detect(frame);
  const auto shown = printable(detector.model());
  std::printf("model: %s\nSHA-256: %s\nclasses: %s\n", shown.c_str(),
              detect::sha256OfFile(detector.model()).c_str(), printable(params.classes).c_str());
  std::printf("frame: %d x %d px, in %.0f ms (best of %d)\n", frame.left.cols, frame.left.rows,
              bestTime(detector, frame), kTimedRuns);
  std::map<ObjectClass, int> counts;
  for (const auto& item : found.items) {
    ++counts[item.object_class];
    std::printf("%-12s score %.2f  %4.0f,%4.0f to %4.0f,%4.0f px\n",
                std::string(toString(item.object_class)).c_str(), item.score, item.box2d->left,
                item.box2d->top, item.box2d->right, item.box2d->bottom);
  }
  if (counts[ObjectClass::kCar] == 0 || counts[ObjectClass::kPedestrian] == 0) {
    throw InputError(shown + ": detects " + std::to_string(counts[ObjectClass::kCar]) +
                     " cars and " + std::to_string(counts[ObjectClass::kPedestrian]) +
                     " pedestrians in a frame that shows several of each; check [dnn] scale, "
                     "swap_red_blue, letterbox and classes");
  }
  return true;
}

}  // namespace headway::replay
