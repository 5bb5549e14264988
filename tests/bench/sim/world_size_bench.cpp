// SPDX-License-Identifier: BSD-3-Clause
// Cost of a frame in a small and in a large world with the same surroundings of the robot.
//   bench_world_size [FRAMES]
// The streets begin alike; the large ones go on for 30 km. Pictures are small, so that the cost of
// looking around shows beside that of drawing. Times are of the processor, all threads together.
#include <headway/core/stage_times.h>
#include <headway/sim/simulator.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

namespace {

using namespace headway;

struct Cost {
  double length_m = 0.0;
  double start_up_s = 0.0;  ///< up to the first frame
  double frame_ms = 0.0;
  std::vector<cv::Mat> pictures;
};

Cost costOf(const std::string& shape, int frames) {
  sim::SimParams params;
  params.route.shape = shape;
  params.camera.width = 320;
  params.camera.height = 96;
  params.camera.focal_px = 185;
  params.traffic.vehicles = 14;
  params.traffic.pedestrians = 40;
  params.recording.frames = frames;
  Cost cost;
  const double begin = processorSeconds();
  sim::Simulator simulator(params);
  cost.length_m = simulator.pathLength();
  cost.pictures.push_back(simulator.next()->left);
  const double first = processorSeconds();
  cost.start_up_s = first - begin;
  while (auto frame = simulator.next()) cost.pictures.push_back(frame->left);
  // With the first frame the second was drawn, too.
  cost.frame_ms = 1e3 * (processorSeconds() - first) / (frames - 2);
  return cost;
}

bool same(const std::vector<cv::Mat>& a, const std::vector<cv::Mat>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (cv::norm(a[i], b[i], cv::NORM_INF) > 0.0) return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 100;
  if (frames < 3) {
    std::fprintf(stderr, "bench_world_size [FRAMES], at least 3\n");
    return 2;
  }
  const std::string begin = "straight 90, left 60 60, straight 100, right 50 60, straight 200";
  std::string large = begin;
  for (int i = 0; i < 60; ++i) large += ", straight 250, left 200 20, straight 120, right 200 20";
  const Cost in_small = costOf(begin, frames), in_large = costOf(large, frames);
  std::printf("| path m | start-up s | frame ms |\n| ---: | ---: | ---: |\n");
  for (const Cost* cost : {&in_small, &in_large}) {
    std::printf("| %.0f | %.2f | %.2f |\n", cost->length_m, cost->start_up_s, cost->frame_ms);
  }
  std::printf("Both see the same pictures: %s\n",
              same(in_small.pictures, in_large.pictures) ? "yes" : "no");
  return 0;
}
