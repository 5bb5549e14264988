// SPDX-License-Identifier: BSD-3-Clause
// Latency of live operation: a recording's first frames are pushed in a loop at a camera's rate.
//
//     bench_latency -i IN.rawlog --rate 10 [--factors 1,2,10] [--frames 1000] [--clip 200]
//
// Printed is the time from the arrival of a frame's second image to its published tracks, less the
// frame's own process(): the delay by queues, decoding, rectification and publication. Images are
// decoded from the rawlog before the measurement; they must be embedded.

#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/io/detection_observation.h>
#include <headway/program/command_line.h>
#include <headway/run/session.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/serialization/CArchive.h>

#include <atomic>
#include <cstdio>
#include <sstream>
#include <thread>

namespace {

using namespace headway;
using mrpt::obs::CObservation;

/// Observations up to and including each stereo pair.
using Clip = std::vector<std::vector<CObservation::Ptr>>;

Clip readClip(const std::string& path, int max_frames) {
  io::registerClasses();
  mrpt::io::CFileGZInputStream file;
  if (!file.open(path)) throw InputError(path + ": cannot be read");
  auto archive = mrpt::serialization::archiveFrom(file);
  Clip clip(1);
  while (static_cast<int>(clip.size()) <= max_frames) {
    CObservation::Ptr observation;
    try {
      observation = std::dynamic_pointer_cast<CObservation>(archive.ReadObject());
    } catch (const mrpt::serialization::CExceptionEOF&) {
      break;
    }
    if (observation == nullptr) continue;
    clip.back().push_back(observation);
    if (dynamic_cast<const mrpt::obs::CObservationStereoImages*>(observation.get()) != nullptr) {
      clip.emplace_back();
    }
  }
  clip.pop_back();
  if (clip.size() < 2) throw InputError(path + ": holds fewer than two embedded stereo pairs");
  return clip;
}

/// Pushes the clip in a loop, a stereo pair every `interval_s`, until told to stop; times go on
/// over the loops.
void play(const Clip& clip, double interval_s, const std::atomic<bool>& stop,
          io::LiveSource& source) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto first = clip.front().back()->timestamp;
  const auto last = clip.back().back()->timestamp;
  const auto lap = last - first + (last - first) / static_cast<int>(clip.size() - 1);
  for (int i = 0; !stop; ++i) {
    const auto count = static_cast<int>(clip.size());
    for (const auto& recorded : clip[static_cast<std::size_t>(i % count)]) {
      const auto observation =
          std::dynamic_pointer_cast<CObservation>(recorded->duplicateGetSmartPtr());
      observation->timestamp += (i / count) * lap;
      if (recorded == clip[static_cast<std::size_t>(i % count)].back()) {
        std::this_thread::sleep_until(start + std::chrono::duration_cast<Clock::duration>(
                                                  std::chrono::duration<double>(i * interval_s)));
      }
      source.push(observation);
    }
  }
  source.close();
}

void print(double factor, double interval_s, std::size_t frames,
           const std::vector<run::FrameResult>& updates) {
  std::vector<double> process, wait, first_third, last_third;
  for (std::size_t i = 0; i < updates.size(); ++i) {
    process.push_back(1e3 * updates[i].process_s());
    wait.push_back(1e3 * updates[i].overhead_s());
    if (3 * i < updates.size()) first_third.push_back(wait.back());
    if (3 * i >= 2 * updates.size()) last_third.push_back(wait.back());
  }
  const double interval_ms = 1e3 * interval_s;
  std::printf(
      "| %g | %.1f | %zu | %zu | %zu | %.1f / %.1f | %.1f / %.1f / %.1f / %.1f | %.2f | %.2f, %.2f "
      "|\n",
      factor, interval_ms, frames, updates.size(), frames - updates.size(),
      percentile(process, 0.5), percentile(process, 0.99), percentile(wait, 0.5),
      percentile(wait, 0.9), percentile(wait, 0.99), percentile(wait, 1.0),
      percentile(wait, 0.99) / interval_ms, percentile(first_third, 0.99) / interval_ms,
      percentile(last_third, 0.99) / interval_ms);
}

/// Processes the looped clip at one rate.
void measure(const Clip& clip, double rate_hz, double factor, int frames,
             const pipeline::PerceptionParams& params) {
  const double interval_s = 1.0 / (rate_hz * factor);
  io::LiveSource source;
  std::atomic<bool> stop{false};
  std::thread camera([&] { play(clip, interval_s, stop, source); });
  std::vector<run::FrameResult> updates;
  std::size_t newest = 0;
  try {
    pipeline::Perception perception(source.camera(), params);
    map::SharedMap shared;
    run::SensorFrames frames_in(source);
    run::MapPublisher publisher(shared);
    run::Session session(frames_in, perception, {&publisher});
    while (newest + 1 < static_cast<std::size_t>(frames)) {  // then the camera still runs
      updates.push_back(session.next().value());
      newest = updates.back().frame.index;
      updates.back().frame.stereo.reset();
    }
  } catch (...) {
    stop = true;
    camera.join();
    throw;
  }
  stop = true;
  camera.join();
  print(factor, interval_s, newest + 1, updates);
}

int runBench(int argc, const char* const* argv) {
  std::string input, factors = "1,2,10";
  double rate_hz = 10.0;
  int frames = 1000, clip_frames = 200;
  pipeline::PerceptionParams settings;
  Params params;
  settings.describe(params);
  program::CommandLine line("bench_latency", "Measures the latency of live operation.");
  line.option(input, 'i', "input", "IN.rawlog", "rawlog with embedded stereo images", true);
  line.option(rate_hz, 0, "rate", "HZ", "rate of the camera");
  line.option(factors, 0, "factors", "X,...", "multiples of that rate");
  line.option(frames, 0, "frames", "N", "stereo pairs to push");
  line.option(clip_frames, 0, "clip", "N", "stereo pairs of the recording to repeat");
  line.parameters(params);
  if (!line.parse(argc, argv)) return program::kDone;
  const auto clip = readClip(input, clip_frames);
  std::printf("%zu frames repeated; times in ms\n", clip.size());
  std::puts(
      "| rate | interval | pushed | processed | dropped | process median / 99 % | added latency "
      "median / 90 % / 99 % / max | 99 % in intervals | of the first, last third |");
  std::puts("| ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |");
  std::istringstream list(factors);
  for (std::string factor; std::getline(list, factor, ',');) {
    measure(clip, rate_hz, std::stod(factor), frames, pipeline::PerceptionParams::live(settings));
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("bench_latency", [&] { return runBench(argc, argv); });
}
