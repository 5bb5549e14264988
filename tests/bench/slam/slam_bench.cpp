// SPDX-License-Identifier: BSD-3-Clause
// Cost of each stage of localisation and mapping on one rawlog, with a reference workload that
// makes figures of different machines comparable.
//
//     bench_slam -i IN.rawlog [--set slam.key=value ...]
//
// The reference is OpenCV's ORB, detect and compute with 2,000 features, on both images of each
// pair, measured frame by frame between the frames. Everything runs in one thread.

#include <headway/core/error.h>
#include <headway/core/stage_times.h>

#include <cstdio>
#include <opencv2/core/utility.hpp>

#include "../reference_workload.h"
#include "slam_bench_line.h"

namespace {

using namespace headway;

void printTimes(const StageTimes& times) {
  const auto summary = times.summary();
  for (const auto& [stage, of] : summary) {
    std::printf("%-12s median %7.2f ms   p95 %7.2f ms   max %7.2f ms\n", stage.c_str(),
                of.median_ms, of.p95_ms, of.max_ms);
  }
  const double reference = summary.at("reference").median_ms;
  for (const char* stage : {"slam_track", "frame"}) {
    std::printf("%s / reference %.2f\n", stage, summary.at(stage).median_ms / reference);
  }
}

int measure(int argc, const char* const* argv) {
  std::string input;
  SlamBenchLine setup("bench_slam", "Times stereo SLAM against OpenCV's ORB on one rawlog.");
  setup.line.option(input, 'i', "input", "IN.rawlog", "rawlog with stereo images", true);
  if (!setup.line.parse(argc, argv)) return program::kDone;

  cv::setNumThreads(1);
  io::RawlogSource source(input, {});
  pipeline::Perception perception(source.camera(), setup.settings);
  StageTimes reference;
  double processor_ms = 0.0;
  std::size_t frames = 0;
  std::size_t lost = 0;
  while (auto frame = source.next()) {
    const double before = processorSeconds();
    const auto update = perception.process(*frame);
    processor_ms += 1e3 * (processorSeconds() - before);
    if (frame->stereo)
      bench::measureReferenceWorkload(frame->stereo->left, frame->stereo->right, reference);
    lost += update.camera.status == slam::TrackingStatus::kLost ? 1 : 0;
    ++frames;
  }
  if (reference.empty()) throw InputError(input + ": holds no stereo images");
  const auto& static_map = *perception.map().staticMap();
  std::printf("%zu frames, %zu lost, %zu keyframes, %zu landmarks\n", frames, lost,
              static_map.keyframes.size(), static_map.landmarks.size());
  if (const auto error = errorOf(perception.trajectory(), io::readTruth(input).poses)) {
    std::printf("ATE RMSE %.4f m over %.1f m\n", error->ate_m.rmse, error->path_m);
  }
  StageTimes times = perception.times();
  times.merge(reference);
  printTimes(times);
  std::printf("processor %.2f ms a frame\n", processor_ms / static_cast<double>(frames));
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_slam", [&] { return measure(argc, argv); });
}
