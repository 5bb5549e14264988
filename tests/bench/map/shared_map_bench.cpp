// SPDX-License-Identifier: BSD-3-Clause
// How long publishing a map holds perception up while others read it.
//
// A writer publishes 10,000 maps of 100,000 landmarks and 50 tracks, 1,000 a second. Beside it one
// reader plans at 20 Hz, with queries, and two take snapshots 1,000 times a second.

#include <headway/map/map_query.h>
#include <headway/map/shared_map.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <thread>

#include "example_world.h"

namespace {

using namespace headway;
using Clock = std::chrono::steady_clock;

constexpr int kUpdates = 10000;
constexpr int kUpdatesBetweenKeyframes = 1000;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

std::vector<Track> manyTracks(int frame) {
  std::vector<Track> tracks;
  for (int i = 0; i < 50; ++i) {
    tracks.push_back(map::exampleTrack(i, ObjectClass::kCar, {2.0 * i, 0.01 * frame, 0.75}, 0.0));
  }
  return tracks;
}

void report(const char* what, std::vector<double> times_ms) {
  std::sort(times_ms.begin(), times_ms.end());
  const auto share = [&](double p) {
    return times_ms[static_cast<std::size_t>(p * static_cast<double>(times_ms.size() - 1))];
  };
  std::printf("%-28s median %.4f ms, 99 %% %.4f ms, 99.9 %% %.4f ms, longest %.4f ms\n", what,
              share(0.5), share(0.99), share(0.999), times_ms.back());
}

}  // namespace

int main() {
  map::SharedMap shared;
  std::atomic<bool> done{false};
  std::atomic<std::size_t> planned{0}, taken{0};
  std::thread planner([&] {
    while (!done) {
      const auto snapshot = shared.snapshot();
      const Time now = snapshot->movingObjects().time();
      static_cast<void>(snapshot->at(now).timeToCollision(
          {0.5, 0.4, false}, {{now, {0.0, 0.0}, 0.0}, {now + 3.0, {3.0, 0.0}, 0.0}}));
      ++planned;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  });
  const auto take = [&] {
    while (!done) {
      if (shared.snapshot()->movingObjects().time() < 0.0) std::abort();
      ++taken;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  std::thread viewer(take), logger(take);
  map::PerceptionMap map;
  std::vector<double> publish_ms, update_ms;
  for (int i = 0; i < kUpdates; ++i) {
    if (i % kUpdatesBetweenKeyframes == 0) map.update(map::exampleStaticMap(100000));
    auto tracks = manyTracks(i);
    auto start = Clock::now();
    map.update(0.001 * i, std::move(tracks));
    update_ms.push_back(millisecondsSince(start));
    start = Clock::now();
    shared.publish(map);
    publish_ms.push_back(millisecondsSince(start));
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  done = true;
  for (auto* thread : {&planner, &viewer, &logger}) thread->join();
  report("update with 50 tracks", update_ms);
  report("publish (bar 99.9 %: 1 ms)", publish_ms);
  std::printf("%zu plans, %zu snapshots meanwhile\n", planned.load(), taken.load());
}
