// headway-replay: a stereo rawlog in; trajectory, tracks, predictions, map and pictures out.
#include <headway/program/progress.h>

#include <cstdio>

#include "replay.h"

using headway::program::CommandLine;

int main(int argc, char** argv) {
  return headway::program::run("headway-replay", [&] {
    headway::replay::Options options;
    headway::pipeline::PerceptionParams perception_params;
    headway::Params params;
    perception_params.describe(params);

    CommandLine line("headway-replay",
                     "Replays a stereo rawlog: localises the camera, maps the still world, tracks "
                     "and predicts what moves, and leaves all of it in OUTDIR.");
    headway::replay::describe(options, line);
    line.parameters(params);
    if (!line.parse(argc, argv)) return headway::program::kDone;
    options.quiet = line.quiet();
    headway::replay::check(options);
    if (!options.detector.empty()) perception_params.detection.detector = options.detector;

    headway::program::catchInterrupts();
    headway::replay::Replay replay(options, perception_params, params);
    replay.run();
    if (!options.quiet) {
      headway::replay::printSummary(replay.summary());
      for (const auto& picture : replay.pictures()) std::printf("picture: %s\n", picture.c_str());
      std::printf("report: %s/report.html\n", options.output.c_str());
    }
    return headway::program::kDone;
  });
}
