// headway-sim: worlds with truth -> stereo rawlogs.
#include <headway/core/error.h>
#include <headway/program/command_line.h>
#include <headway/program/progress.h>
#include <headway/sim/recording.h>
#include <headway/sim/simulator.h>

#include <algorithm>
#include <filesystem>
#include <future>
#include <iomanip>
#include <iostream>
#include <opencv2/core.hpp>
#include <sstream>

namespace {

using namespace headway;

struct Request {
  std::string output;
  std::optional<std::size_t> seed, frames;
  bool overwrite = false;
  sim::RecordingOptions options;
};

/// The options that stand for a parameter, as that parameter.
void applyShortcuts(const Request& request, Params& params) {
  if (request.seed) params.set("world.seed=" + std::to_string(*request.seed));
  if (request.frames) params.set("recording.frames=" + std::to_string(*request.frames));
}

/// How much disk the recording will take, said before it is taken.
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
                     ": has not enough room; choose fewer frames ([recording] "
                     "frames) or storage = external_jpeg");
  }
}

/// How much of the images the movers covered, for the summary.
class CoveredShare {
 public:
  void add(const sim::SimFrame& frame) {
    const cv::Mat mask = sim::dynamicMask(frame);
    const double share = cv::countNonZero(mask) / static_cast<double>(mask.total());
    if (frames_ == 0) first_ = share;
    most_ = std::max(most_, share);
    sum_ += share;
    ++frames_;
  }
  friend std::ostream& operator<<(std::ostream& out, const CoveredShare& share) {
    const double mean = share.frames_ > 0 ? share.sum_ / share.frames_ : 0.0;
    return out << std::fixed << std::setprecision(1) << "movers cover " << 100.0 * mean
               << " % of the left image (first frame " << 100.0 * share.first_ << " %, most "
               << 100.0 * share.most_ << " %)";
  }

 private:
  double first_ = 0.0, most_ = 0.0, sum_ = 0.0;
  int frames_ = 0;
};

int simulate(int argc, const char* const* argv) {
  Request request;
  sim::SimParams settings;
  Params params;
  settings.describe(params);
  program::CommandLine line("headway-sim", "Draws a world as a stereo rawlog, with its truth.");
  line.parameters(params);
  line.option(request.output, 'o', "output", "OUT.rawlog", "rawlog to write", true);
  line.option(request.seed, 0, "seed", "N", "instead of [world] seed");
  line.option(request.frames, 0, "frames", "N", "instead of [recording] frames");
  line.flag(request.options.masks, 0, "masks", "also write masks of what moves");
  line.flag(request.options.depth, 0, "depth", "also write depth images");
  line.flag(request.overwrite, 'w', "overwrite", "overwrite an output that exists");
  if (!line.parse(argc, argv)) return program::kDone;
  applyShortcuts(request, params);
  program::requireWritable(request.output, request.overwrite);
  program::requireWritable(sim::truthFolder(request.output), request.overwrite);
  std::ostringstream world_ini;
  params.print(world_ini);

  program::catchInterrupts();
  sim::Simulator simulator(settings);
  auto frame = simulator.next();
  if (frame && !line.quiet()) announceSize(*frame, settings, request);
  sim::Recording recording(request.output, settings.recording, request.options, simulator.camera(),
                           simulator.recordedCamera(), world_ini.str());
  program::Progress progress("headway-sim", line.quiet());
  CoveredShare covered;
  std::size_t done = 0;
  std::future<void> writing;  // one frame is written while the next one is drawn
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
  if (!line.quiet()) {
    std::cout << request.output << ": " << done << " frames; truth in "
              << sim::truthFolder(request.output) << "\n"
              << covered << std::endl;
  }
  const auto wanted = static_cast<std::size_t>(settings.recording.frames);
  if (done < wanted && simulator.arrived()) {
    std::cerr << "headway-sim: the path ended after " << done << " of " << wanted
              << " frames: lengthen it (section [route]) or ask for fewer ([recording] frames)"
              << std::endl;
  }
  return program::kDone;
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("headway-sim", [&] { return simulate(argc, argv); });
}
