// SPDX-License-Identifier: BSD-3-Clause
// Cost of the occupancy grid: 600 scans along 1.2 km, 600 rays each.

#include <headway/map/static_grid.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>

namespace {

using namespace headway;
using Clock = std::chrono::steady_clock;

constexpr int kLooks = 600;
constexpr int kRays = 600;

template <typename Work>
double millisecondsOf(const Work& work) {
  const auto start = Clock::now();
  work();
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

void report(const char* what, std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  std::printf("%-44s median %.3f ms, longest %.3f ms\n", what, times_ms[times_ms.size() / 2],
              times_ms.back());
}

GroundScan exampleScan() {
  GroundScan scan;
  for (int i = 0; i < kRays; ++i) {
    const float angle = 1.4f * (static_cast<float>(i) / kRays - 0.5f);
    const Eigen::Vector3f along(std::cos(angle), std::sin(angle), 0.f);
    const float range = 12.f + 6.f * std::sin(9.f * angle);
    scan.free.push_back({4.f * along, range * along});
    scan.obstacles.push_back({(range + 0.3f) * along, 0.2f});
  }
  return scan;
}

}  // namespace

int main() {
  std::vector<slam::KeyframeView> keyframes(kLooks);
  for (int i = 0; i < kLooks; ++i) {
    keyframes[i].id = KeyframeId{i};
    keyframes[i].T_map_robot = Eigen::Translation3d(2.0 * i, 0.1 * i, 0.0);
  }
  map::StaticGrid grid({});
  grid.follow(keyframes);
  const GroundScan scan = exampleScan();
  std::vector<double> add_ms, grid_ms, still_ms, moved_ms;
  for (const auto& keyframe : keyframes) {
    add_ms.push_back(millisecondsOf([&] { grid.add(keyframe.T_map_robot, scan); }));
    grid_ms.push_back(millisecondsOf([&] { (void)grid.grid(); }));
  }
  for (int i = 0; i < 20; ++i) {
    still_ms.push_back(millisecondsOf([&] { grid.follow(keyframes); }));
  }
  for (int i = 1; i <= 5; ++i) {
    for (auto& keyframe : keyframes) keyframe.T_map_robot.translation().y() += 0.3 * i;
    moved_ms.push_back(millisecondsOf([&] { grid.follow(keyframes); }));
  }
  const auto last = grid.grid();
  std::printf("%u x %u cells\n", last->getSizeX(), last->getSizeY());
  report("a scan added", add_ms);
  report("the grid as MRPT's layer", grid_ms);
  report("600 keyframes followed, none of them moved", still_ms);
  report("600 keyframes followed, all moved by a loop", moved_ms);
}
