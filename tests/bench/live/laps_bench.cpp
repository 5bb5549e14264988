// SPDX-License-Identifier: BSD-3-Clause
// Memory and time of a run of weeks: one lap is driven again and again by the complete pipeline
// with all files of a replay, except that the boxes are made.
//
//     bench_laps [--frames N] [--laps N] -o OUTDIR

#include <headway/program/command_line.h>

#include <cstdio>

#include "lap_replay.h"

namespace {

using namespace headway;

int runBench(int argc, const char* const* argv) {
  int frames = 200000;
  int laps = 100;
  std::string folder;
  program::CommandLine line("bench_laps",
                            "Shows whether memory and time grow with a run's length.");
  line.option(folder, 'o', "output", "OUTDIR", "folder of results, overwritten", true);
  line.option(frames, 0, "frames", "N", "frames of the run");
  line.option(laps, 0, "laps", "N", "laps of a row of the table");
  if (!line.parse(argc, argv)) return program::kDone;
  if (frames < 1 || laps < 1) throw program::UsageError("--frames and --laps must be positive");
  std::puts(
      "| frames | resident MB | allocated MB | processor ms | frame ms | 99 % | keyframes | "
      "landmarks | tracks |");
  std::puts("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
  const auto print = [](const bench::LapFigures& row) {
    std::printf("| %zu | %.1f | %.2f | %.2f | %.2f | %.2f | %zu | %zu | %zu |\n", row.frames,
                row.resident_mb, row.allocated_mb, row.cpu_ms, row.median_ms, row.p99_ms,
                row.keyframes, row.landmarks, row.tracks);
    std::fflush(stdout);
  };
  bench::replayLaps(static_cast<std::size_t>(frames), static_cast<std::size_t>(laps), folder,
                    print);
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_laps", [&] { return runBench(argc, argv); });
}
