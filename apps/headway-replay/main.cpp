// SPDX-License-Identifier: BSD-3-Clause
// headway-replay: stereo rawlog to trajectory, tracks, predictions, map and pictures.
#include <headway/program/progress.h>

#include <cstdio>

#include "check_model.h"
#include "recordings.h"
#include "replay.h"

using headway::program::CommandLine;

namespace {

void replayOne(const headway::replay::Options& options,
               const headway::pipeline::PerceptionParams& perception_params,
               const headway::Params& params) {
  headway::replay::Replay replay(options, perception_params, params);
  replay.run();
  if (options.quiet) return;
  headway::replay::printSummary(replay.summary());
  for (const auto& picture : replay.pictures()) std::printf("picture: %s\n", picture.c_str());
  std::printf("report: %s/report.html\n", options.output.c_str());
}

}  // namespace

int main(int argc, char** argv) {
  return headway::program::run("headway-replay", [&] {
    headway::replay::Options options;
    headway::pipeline::PerceptionParams perception_params;
    headway::Params params;
    perception_params.describe(params);
    headway::replay::describeCheckpoints(options.checkpoint_s, params);

    CommandLine line(
        "headway-replay",
        "Processes a stereo rawlog: localises the camera, maps what stands still, tracks and "
        "predicts what moves, places the map on the earth by satellite fixes; results: OUTDIR.");
    headway::replay::describe(options, line);
    line.parameters(params);
    if (!line.parse(argc, argv)) return headway::program::kDone;
    options.quiet = line.quiet() || line.verbosity() > mrpt::system::LVL_INFO;
    options.debug = line.verbosity() == mrpt::system::LVL_DEBUG;
    headway::replay::check(options);
    const auto& network = perception_params.detection.detect.network;
    if (headway::replay::checkModel(options.check_model, network)) return headway::program::kDone;
    if (!options.detector.empty()) perception_params.detection.detector = options.detector;

    headway::program::catchInterrupts();
    if (options.inputs.size() > 1) {
      headway::replay::Recordings(options, perception_params, params).run();
    } else {
      options.input = options.inputs.front();
      replayOne(options, perception_params, params);
    }
    return headway::program::kDone;
  });
}
