// SPDX-License-Identifier: BSD-3-Clause
// Processor time of the moving-object layer with many boxes a frame, beside that of the reference
// workload on the bundled street's first images.
//
//     bench_load [FRAMES]
//
// `random`: boxes at random places in every frame, so that tracks start and end all the time.
// `walkers`: people that walk or stand, 3 m apart. `crowd`: the same people 1 m apart.
#include <headway/core/stage_times.h>
#include <headway/io/rawlog_source.h>
#include <headway/objects/moving_object_tracker.h>
#include <headway_test/paths.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "../reference_workload.h"

namespace {

using namespace headway;

constexpr double kFrame_s = 0.1;

Detection personAt(double x, double y) {
  Detection detection;
  detection.object_class = ObjectClass::kPedestrian;
  Box3d box;
  box.centre = {x, 0.8, y};
  box.length = 0.8;
  box.width = 0.6;
  box.height = 1.7;
  detection.box3d = box;
  return detection;
}

std::vector<Detection> randomBoxes(int count, std::mt19937& random) {
  std::uniform_real_distribution<double> across(-30.0, 30.0), ahead(5.0, 65.0);
  std::vector<Detection> boxes;
  for (int i = 0; i < count; ++i) boxes.push_back(personAt(across(random), ahead(random)));
  return boxes;
}

std::vector<Detection> people(int count, double spacing_m, double time, std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, 0.05);
  const int columns = std::max(1, static_cast<int>(std::sqrt(count)));
  std::vector<Detection> boxes;
  for (int i = 0; i < count; ++i) {
    const double x = spacing_m * (i % columns - columns / 2) + (i % 2 == 0 ? 1.2 * time : 0.0);
    boxes.push_back(personAt(x + noise(random), 5.0 + spacing_m * (i / columns) + noise(random)));
  }
  return boxes;
}

/// Median and maximum after the first frames [ms].
struct Times {
  double median = 0.0;
  double max = 0.0;
  std::size_t tracks = 0;
};

Times timesOf(const std::string& kind, int count, int frames) {
  objects::MovingObjectTracker tracker{objects::ObjectsParams()};
  std::mt19937 random(1);
  std::vector<double> ms;
  Times times;
  for (int i = 0; i < frames; ++i) {
    Detections detections;
    detections.time = kFrame_s * i;
    detections.items = kind == "random"
                           ? randomBoxes(count, random)
                           : people(count, kind == "crowd" ? 1.0 : 3.0, detections.time, random);
    const double start_s = processorSeconds();
    const auto update = tracker.update(static_cast<std::size_t>(i),
                                       {detections.time, Pose::Identity()}, detections);
    const double elapsed_ms = 1e3 * (processorSeconds() - start_s);
    if (i >= frames / 5) ms.push_back(elapsed_ms);
    times.tracks = update.tracks.size();
  }
  std::sort(ms.begin(), ms.end());
  times.median = ms[ms.size() / 2];
  times.max = ms.back();
  return times;
}

double referenceMs() {
  io::RawlogSource source(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog", {});
  const auto frame = source.next();
  StageTimes unused;
  std::vector<double> ms;
  for (int i = 0; i < 15; ++i) {
    const double start_s = processorSeconds();
    bench::measureReferenceWorkload(frame->stereo->left, frame->stereo->right, unused);
    ms.push_back(1e3 * (processorSeconds() - start_s));
  }
  std::sort(ms.begin(), ms.end());
  return ms[ms.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::max(10, std::atoi(argv[1])) : 60;
  const double reference = referenceMs();
  std::printf("reference workload %.1f ms\n", reference);
  std::printf("%-8s %6s %10s %8s %8s %7s\n", "boxes", "count", "references", "ms", "max ms",
              "tracks");
  for (const char* kind : {"random", "walkers", "crowd"}) {
    for (const int count : {50, 200, 1000}) {
      const Times times = timesOf(kind, count, frames);
      std::printf("%-8s %6d %10.3f %8.2f %8.2f %7zu\n", kind, count, times.median / reference,
                  times.median, times.max, times.tracks);
    }
  }
}
