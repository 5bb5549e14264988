// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/moving_object_error.h>
#include <headway/eval/plots.h>
#include <headway/plot/text_table.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace headway::app {
namespace {

struct MoversOptions {
  std::string truth;
  std::string poses;
  std::string estimate;
  bool quiet = false;
  Outputs outputs;
};

bool parseMovers(MoversOptions& options, int argc, const char** argv) {
  program::CommandLine line("headway-eval movers",
                            "Evaluates which moving objects a replay finds, its false moving "
                            "tracks, and the objects' motion from frame to frame.");
  line.option(options.truth, 0, "truth", "LABELS", "KITTI tracking labels", true);
  line.option(options.poses, 0, "poses", "P",
              "True pose of every frame: KITTI (camera), TUM (robot), or a rawlog with truth_pose",
              true);
  line.option(options.estimate, 0, "estimate", "OUTDIR", "Output folder of headway-replay", true);
  options.outputs.describe(line);
  if (!line.parse(argc, argv)) return false;
  options.quiet = line.quiet();
  options.outputs.requireWritable({options.truth, options.estimate});
  return true;
}

void reportTracks(const eval::MovingObjectError& error) {
  std::cout << "\n"
            << error.tracks.size() << " moving tracks in " << error.frames << " frames, "
            << error.false_tracks << " false ("
            << plot::fixedText(error.falseTracksPer100Frames(), 1) << " per 100 frames); "
            << error.duplicate_rows << " rows on an object that has another row\n";
  for (const auto& track : error.tracks) {
    if (track.wrong == 0) continue;
    std::cout << "track " << track.id << " (" << toString(track.object_class) << "), frames "
              << track.first_frame << " to " << track.last_frame << ": " << track.wrong << " of "
              << track.rows << " moving rows are wrong\n";
  }
  for (const auto& [reason, count] : error.ignored) {
    std::cout << count << " moving rows were ignored: " << reason << "\n";
  }
}

void report(const eval::MoverEvaluation& results) {
  plot::writeTable(std::cout, eval::tableOf(results.error));
  reportTracks(results.error);
  const auto& coasting = results.with_coasting.all;
  std::cout << "with coasting tracks: recall " << plot::percentText(coasting.recall(), 1)
            << " %, precision " << plot::percentText(coasting.precision(), 1) << " %\n\n";
  plot::writeTable(std::cout, eval::tableOf(results.labelled));
  const auto motion = [](const std::string& title, const eval::ObjectMotionErrors& errors) {
    std::cout << "\n" << title << "\n\n";
    plot::writeTable(std::cout, eval::tableOf(errors));
  };
  motion("Motion by the tracks' poses", results.motion);
  motion("Motion by the tracks' velocities", results.motion_velocity);
  motion("Motion by the smoothed tracks", results.motion_smoothed);
}

/// Paths of labelled objects and of moving tracks in the world.
cv::Mat plot(const eval::MovingObjectInput& input) {
  auto labels = input.labels;
  labels.resize(std::min(labels.size(), input.T_world_cam.size()));
  eval::TrackMap map{
      "Labels and moving tracks", eval::trueObjects(labels, input.T_world_cam), {}, {}, {}};
  std::map<std::int64_t, eval::TrueObject> tracks;
  for (const auto& row : input.rows) {
    if (!row.moving || row.frame >= input.T_world_cam.size()) continue;
    auto& track = tracks[row.id];
    track.id = row.id;
    track.object_class = row.object_class;
    const auto& [time, T_world_cam] = input.T_world_cam[row.frame];
    track.path.push_back({row.frame, time, T_world_cam * row.centre, 0.0});
  }
  for (auto& [id, track] : tracks) map.tracks.push_back(std::move(track));
  for (const auto& pose : input.T_world_cam) {
    map.camera_path.emplace_back(pose.value.translation().head<2>());
  }
  return eval::trackMapPlot(map);
}

}  // namespace

int runMovers(int argc, const char** argv) {
  MoversOptions options;
  if (!parseMovers(options, argc, argv)) return program::kDone;
  const auto results = eval::evaluateMovers(options.truth, options.poses, options.estimate);
  if (!options.quiet) report(results);
  options.outputs.write([&] { return toJson(results); }, [&] { return plot(results.input); });
  return program::kDone;
}

}  // namespace headway::app
