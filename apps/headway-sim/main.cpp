// SPDX-License-Identifier: BSD-3-Clause
// headway-sim: simulates a world into a stereo rawlog with truth.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>
#include <headway/sim/recording.h>
#include <headway/sim/rigs.h>
#include <headway/sim/simulator.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <iomanip>
#include <iostream>
#include <opencv2/core.hpp>

namespace {

using namespace headway;

/// Command-line options.
struct Request {
  std::string output;
  std::string rig;
  std::optional<std::size_t> seed, frames;
  bool overwrite = false;
  bool quiet = false;
  sim::RecordingOptions options;
};

/// Prints the expected size of the recording.
///
/// @throws InputError if the disk space is insufficient
void announceSize(const sim::SimFrame& first, const sim::SimParams& params,
                  const Request& request) {
  const auto total = static_cast<std::size_t>(params.recording.frames);
  const double megabytes =
      sim::estimateMegabytes({first}, params.recording, request.options, total);
  const auto folder = std::filesystem::absolute(request.output).parent_path();
  const double free = static_cast<double>(std::filesystem::space(folder).available) / 1e6;
  std::cout << "about " << std::fixed << std::setprecision(1) << megabytes << " MB for " << total
            << " frames; " << std::setprecision(0) << free << " MB are free" << std::endl;
  if (megabytes > free) {
    throw InputError(folder.string() +
                     ": insufficient disk space; reduce [recording] frames or use "
                     "storage = external_jpeg");
  }
}

/// Statistics of the image ratio covered by moving objects.
class CoveredRatio {
 public:
  void add(const sim::SimFrame& frame) {
    const cv::Mat mask = sim::dynamicMask(frame);
    const double ratio = cv::countNonZero(mask) / static_cast<double>(mask.total());
    if (frames_ == 0) first_ = ratio;
    max_ = std::max(max_, ratio);
    sum_ += ratio;
    ++frames_;
  }
  friend std::ostream& operator<<(std::ostream& out, const CoveredRatio& ratio) {
    const double mean = ratio.frames_ > 0 ? ratio.sum_ / ratio.frames_ : 0.0;
    return out << std::fixed << std::setprecision(1) << "moving objects cover " << 100.0 * mean
               << " % of the left image (first frame " << 100.0 * ratio.first_ << " %, maximum "
               << 100.0 * ratio.max_ << " %)";
  }

 private:
  double first_ = 0.0, max_ = 0.0, sum_ = 0.0;
  int frames_ = 0;
};

/// Returns false if the program is done (--help and similar).
bool parse(int argc, const char* const* argv, Request& request, sim::SimParams& settings,
           Params& params) {
  program::CommandLine line("headway-sim", "Simulates a world into a rawlog with truth.");
  line.parameters(params);
  line.afterFiles([&] {
    if (!request.rig.empty()) sim::applyRig(request.rig, settings.camera);
  });
  line.option(request.output, 'o', "output", "OUT.rawlog", "Rawlog to write", true);
  line.option(
      request.rig, 0, "rig", "NAME",
      "Rig instead of the world file's: car, robot, small, or rgbd (depth camera); --set wins "
      "over it");
  line.option(request.seed, 0, "seed", "N", "Overrides [world] seed");
  line.option(request.frames, 0, "frames", "N", "Overrides [recording] frames");
  line.flag(request.options.masks, 0, "masks", "Also write masks of moving objects");
  line.flag(request.options.depth, 0, "depth", "Also write depth images");
  line.flag(request.overwrite, 'w', "overwrite", "Overwrite an existing output");
  if (!line.parse(argc, argv)) return false;
  request.quiet = line.quiet();
  if (request.seed) params.set("world.seed=" + std::to_string(*request.seed));
  if (request.frames) params.set("recording.frames=" + std::to_string(*request.frames));
  program::requireWritable(request.output, request.overwrite);
  program::requireWritable(sim::truthFolder(request.output), request.overwrite);
  return true;
}

/// Simulates and writes all frames; one frame is written while the next one is rendered.
///
/// @return number of frames written
std::size_t record(sim::Simulator& simulator, const sim::SimParams& settings,
                   const Request& request, const std::string& world_ini, CoveredRatio& covered) {
  auto frame = simulator.next();
  if (frame && !request.quiet) announceSize(*frame, settings, request);
  sim::Recording recording(request.output, settings.recording, request.options, simulator.camera(),
                           simulator.recordedCamera(), world_ini);
  program::Progress progress("headway-sim", request.quiet);
  std::size_t done = 0;
  std::future<void> writing;
  while (frame && !program::interrupted()) {
    if (writing.valid()) writing.get();
    covered.add(*frame);
    writing = std::async(std::launch::async,
                         [&recording, written = std::move(*frame)] { recording.write(written); });
    ++done;
    progress.update(done, static_cast<double>(done) / settings.recording.frames);
    frame = simulator.next();
  }
  if (writing.valid()) writing.get();
  progress.finish();
  recording.close();
  return done;
}

int simulate(int argc, const char* const* argv) {
  Request request;
  sim::SimParams settings;
  Params params;
  settings.describe(params);
  if (!parse(argc, argv, request, settings, params)) return program::kDone;
  sim::Simulator simulator(settings);
  program::catchInterrupts();
  CoveredRatio covered;
  const std::size_t done = record(simulator, settings, request, program::textOf(params), covered);
  if (!request.quiet) {
    std::cout << printable(request.output) << ": " << done << " frames; truth in "
              << printable(sim::truthFolder(request.output)) << "\n"
              << covered << std::endl;
  }
  const auto requested = static_cast<std::size_t>(settings.recording.frames);
  if (done < requested && simulator.arrived()) {
    std::cerr << "headway-sim: the path ended after " << done << " of " << requested
              << " frames; extend it ([route]) or reduce [recording] frames" << std::endl;
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("headway-sim", [&] { return simulate(argc, argv); });
}
