// SPDX-License-Identifier: BSD-3-Clause
// Longest frames of live operation: every frame of a recording is processed with the parameters of
// live operation, at the recorded rate or as fast as possible.
//
//     bench_stall -i IN.rawlog [--realtime FACTOR] [--set section.key=value ...]
//
// Compares the longest process() with the median of those that make keyframes, by wall time and by
// the processor time of the calling thread, which does not depend on other programs, and lists the
// longest ones.

#include <headway/core/statistics.h>
#include <headway/program/command_line.h>
#include <headway/run/session.h>

#include <algorithm>
#include <cstdio>
#include <ctime>
#include <iterator>

namespace {

using namespace headway;

struct FrameTime {
  std::size_t frame = 0;
  double ms = 0.0;
  double processor_ms = 0.0;  ///< of the calling thread
  bool is_keyframe = false;
  std::size_t loops = 0;         ///< candidates tested
  std::vector<double> stage_ms;  ///< of kStages
};

constexpr const char* kStages[] = {"slam_background", "slam_track", "slam_map", "map_update"};

/// Total times of kStages so far; differences of two calls are the times of the frames between.
std::vector<double> totals(const pipeline::Perception& perception) {
  const auto summary = perception.times().summary();
  std::vector<double> result;
  for (const char* stage : kStages) {
    const auto found = summary.find(stage);
    result.push_back(found == summary.end() ? 0.0 : found->second.total_ms);
  }
  return result;
}

double threadMilliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Distribution of one kind of time over all frames and over those that made keyframes.
void printTimes(const char* name, const std::vector<FrameTime>& frames, double FrameTime::*time) {
  std::vector<double> all, keyframes;
  for (const auto& frame : frames) {
    all.push_back(frame.*time);
    if (frame.is_keyframe) keyframes.push_back(frame.*time);
  }
  std::printf("process(), %s, ms\n", name);
  for (const auto* times : {&all, &keyframes}) {
    std::printf("  %-10s median %.1f, 90 %% %.1f, 99 %% %.1f, 99.9 %% %.1f, max %.1f\n",
                times == &all ? "all" : "keyframes", percentile(*times, 0.5),
                percentile(*times, 0.9), percentile(*times, 0.99), percentile(*times, 0.999),
                percentile(*times, 1.0));
  }
  std::printf("  longest / median of keyframes: %.2f\n",
              percentile(all, 1.0) / percentile(keyframes, 0.5));
}

void print(const std::vector<FrameTime>& frames, const pipeline::Perception& perception,
           std::size_t dropped) {
  const auto& map = *perception.map().staticMap();
  std::printf("%zu frames, %zu dropped; %zu keyframes and %zu landmarks at the end\n",
              frames.size(), dropped, map.keyframes.size(), map.landmarks.size());
  printTimes("wall time", frames, &FrameTime::ms);
  printTimes("processor time of the calling thread", frames, &FrameTime::processor_ms);
  std::vector<std::size_t> order(frames.size());
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return frames[a].processor_ms > frames[b].processor_ms;
  });
  order.resize(std::min<std::size_t>(order.size(), 10));
  std::puts("longest by processor time, with the wall time of stages");
  for (const std::size_t i : order) {
    std::printf("  frame %zu: %.1f ms%s, %zu loop candidates", frames[i].frame,
                frames[i].processor_ms, frames[i].is_keyframe ? ", keyframe" : "", frames[i].loops);
    for (std::size_t s = 0; s < std::size(kStages); ++s) {
      std::printf(", %s %.1f", kStages[s], frames[i].stage_ms[s]);
    }
    std::puts("");
  }
}

int runBench(int argc, const char* const* argv) {
  std::string input;
  double realtime = 0.0;
  pipeline::PerceptionParams settings;
  Params params;
  settings.describe(params);
  program::CommandLine line("bench_stall", "Measures the longest frames of live operation.");
  line.option(input, 'i', "input", "IN.rawlog", "rawlog with stereo images", true);
  line.option(realtime, 0, "realtime", "FACTOR", "multiple of the recorded rate; 0: every frame");
  line.parameters(params);
  if (!line.parse(argc, argv)) return program::kDone;
  std::unique_ptr<run::Source> source = std::make_unique<run::RawlogFrames>(input);
  if (realtime > 0.0) source = run::inRealtime(std::move(source), realtime);
  pipeline::Perception perception(source->camera(), pipeline::PerceptionParams::live(settings));
  double before = 0.0;  // the frame
  run::SessionOptions options;
  options.prepare = [&before](RecordedFrame&) { before = threadMilliseconds(); };
  run::Session session(*source, perception, {}, options);
  std::vector<FrameTime> frames;
  std::size_t closed = 0;
  std::vector<double> before_ms = totals(perception);
  while (const auto result = session.next()) {
    const auto& update = result->update;
    frames.push_back({update.frame,
                      1e3 * result->process_s(),
                      threadMilliseconds() - before,
                      update.camera.is_keyframe,
                      update.camera.loops.size(),
                      {}});
    auto total = totals(perception);
    auto& stage_ms = frames.back().stage_ms;
    for (std::size_t s = 0; s < total.size(); ++s) stage_ms.push_back(total[s] - before_ms[s]);
    before_ms = std::move(total);
    for (const auto& loop : update.camera.loops) {
      closed += loop.outcome == slam::LoopOutcome::kClosed ? 1 : 0;
    }
  }
  session.complete();
  print(frames, perception, source->report().dropped);
  std::printf("%zu loops closed\n", closed);
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_stall", [&] { return runBench(argc, argv); });
}
