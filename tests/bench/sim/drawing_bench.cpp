// SPDX-License-Identifier: BSD-3-Clause
// Speed at which a world is rendered and written, with a reference workload that makes figures of
// different machines comparable.
//
//     bench_drawing -c WORLD.ini -o OUT.rawlog [--set section.key=value ...]
//
// Frames go the way they go in headway-sim: one is written while the next is drawn. The reference
// is OpenCV's ORB, detect and compute with 2,000 features in one thread, on both images of every
// tenth pair, measured between the frames. The first frame builds the world and does not count.

#include <headway/core/error.h>
#include <headway/core/stage_times.h>
#include <headway/program/command_line.h>
#include <headway/sim/recording.h>
#include <headway/sim/simulator.h>

#include <chrono>
#include <cstdio>
#include <future>
#include <sstream>
#include <thread>

#include "../reference_workload.h"

namespace {

using namespace headway;

constexpr std::chrono::milliseconds kFinished(100);  // the simulator is busy with the next frame

int measure(int argc, const char* const* argv) {
  std::string output;
  sim::SimParams settings;
  Params params;
  settings.describe(params);
  program::CommandLine line("bench_drawing", "Times the drawing and writing of a world.");
  line.parameters(params);
  line.option(output, 'o', "output", "OUT.rawlog", "rawlog to write; an old one is lost", true);
  if (!line.parse(argc, argv)) return program::kDone;
  std::ostringstream world_ini;
  params.print(world_ini);

  sim::Simulator simulator(settings);
  auto frame = simulator.next();
  sim::Recording recording(output, settings.recording, {}, simulator.camera(),
                           simulator.recordedCamera(), world_ini.str());
  StageTimes times;
  std::size_t objects = 0, count = 0;
  while (frame) {
    if (count % 10 == 0) {
      std::this_thread::sleep_for(kFinished);
      bench::measureReferenceWorkload(frame->left, frame->right, times);
    }
    objects += frame->objects.size();
    ++count;
    const double processor_before = processorSeconds();
    const auto begin = std::chrono::steady_clock::now();
    auto writing = std::async(std::launch::async, [&] { recording.write(*frame); });
    auto next = simulator.next();
    writing.get();
    if (next) {
      const std::chrono::duration<double, std::milli> took =
          std::chrono::steady_clock::now() - begin;
      times.add("pair", took.count());
      times.add("processor", 1e3 * (processorSeconds() - processor_before));
    }
    frame = std::move(next);
  }
  recording.close();
  if (count < 2) throw InputError("[recording] frames: at least 2 are needed");
  const auto summary = times.summary();
  for (const auto& [stage, of] : summary) {
    std::printf("%-10s median %7.2f ms   p95 %7.2f ms   max %7.2f ms\n", stage.c_str(),
                of.median_ms, of.p95_ms, of.max_ms);
  }
  std::printf("%zu pairs, %.1f objects each: %.1f pairs/s, processor / reference %.2f\n", count,
              static_cast<double>(objects) / static_cast<double>(count),
              1e3 / summary.at("pair").median_ms,
              summary.at("processor").median_ms / summary.at("reference").median_ms);
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_drawing", [&] { return measure(argc, argv); });
}
