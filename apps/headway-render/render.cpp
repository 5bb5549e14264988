// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/program/picture_files.h>
#include <headway/program/progress.h>
#include <headway/program/truth_report.h>
#include <headway/report/replay_frames.h>
#include <headway/report/replay_page.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <opencv2/imgproc.hpp>

#include "finished_replay.h"
#include "options.h"

namespace headway::render_program {
namespace {

/// Reconstructs the map, images and truth of frames in ascending order.
class Playback {
 public:
  Playback(const FinishedReplay& replay, report::ReplayTruth truth, std::size_t first_frame,
           const Note& note)
      : replay_(replay),
        truth_(std::move(truth)),
        images_(replay.input, first_frame, note),
        map_(replay.map),
        input_{map_} {
    input_.camera = replay_.camera;
  }

  /// @param position  in the list of frames, not less than the one before
  /// @return          valid until the next call
  const scene::SnapshotInput& at(std::size_t position) {
    const ReplayFrame& frame = replay_.frames[position];
    map_.update(frame.time, frame.tracks);
    input_.frame = frame.frame;
    input_.time = frame.time;
    input_.T_map_robot = frame.T_map_robot;
    input_.image = images_.at(frame.frame);
    for (auto i = input_.path.size(); i <= position; ++i) {
      input_.path.push_back({replay_.frames[i].time, replay_.frames[i].T_map_robot});
    }
    for (; true_poses_ < truth_.path.size() && truth_.path[true_poses_].time <= frame.time;
         ++true_poses_) {
      input_.true_path.push_back(truth_.path[true_poses_]);
    }
    const auto objects = truth_.objects.find(frame.frame);
    input_.true_objects = objects != truth_.objects.end() ? objects->second : std::vector<Track>();
    return input_;
  }

 private:
  const FinishedReplay& replay_;
  report::ReplayTruth truth_;
  report::RecordedImages images_;
  map::PerceptionMap map_;
  scene::SnapshotInput input_;  ///< its paths grow
  std::size_t true_poses_ = 0;  ///< of the truth, in the input's path
};

/// Position of a frame in the list of tracked frames.
std::size_t positionOf(std::size_t frame, const FinishedReplay& replay) {
  const auto& frames = replay.frames;
  const auto found = std::find_if(frames.begin(), frames.end(),
                                  [&](const ReplayFrame& f) { return f.frame == frame; });
  if (found != frames.end()) return static_cast<std::size_t>(found - frames.begin());
  throw InputError("--frame " + std::to_string(frame) + ": is not one of the tracked frames, " +
                   std::to_string(frames.front().frame) + " to " +
                   std::to_string(frames.back().frame));
}

/// Frame rate of the recording [Hz], limited to 1 to 60.
double rateOf(const FinishedReplay& replay) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < replay.frames.size(); ++i) {
    const double frames = static_cast<double>(replay.frames[i].frame - replay.frames[i - 1].frame);
    gaps.push_back((replay.frames[i].time - replay.frames[i - 1].time) / std::max(1.0, frames));
  }
  if (gaps.empty()) return 10.0;
  const double gap = median(std::move(gaps));
  return gap > 0.0 ? std::clamp(std::round(10.0 / gap) / 10.0, 1.0, 60.0) : 10.0;
}

void drawPicture(const Options& options, const FinishedReplay& replay, report::ReplayTruth truth,
                 const Note& note) {
  const std::size_t position =
      options.frame ? positionOf(*options.frame, replay) : replay.frames.size() - 1;
  if (options.kind == OutputKind::kScene) {
    Playback playback(replay, std::move(truth), replay.frames[position].frame,
                      [](const std::string&) {});  // a scene contains no image
    scene::saveScene(options.output, playback.at(position), options.snapshot);
    return;
  }
  Playback playback(replay, std::move(truth), replay.frames[position].frame, note);
  scene::SnapshotRenderer snapshots(options.snapshot);
  program::writePicture(options.output, snapshots.draw(playback.at(position)));
}

void drawVideo(const Options& options, const FinishedReplay& replay, report::ReplayTruth truth,
               const Note& note) {
  scene::SnapshotOptions snapshot = options.snapshot;
  snapshot.width += snapshot.width % 2;  // video encoders require even sizes
  snapshot.height += snapshot.height % 2;
  snapshot.supersampling = 1;  // antialiasing is not visible in motion and doubles the time
  const std::size_t first = options.from_index.value_or(0);
  const std::size_t last = options.to_index.value_or(replay.frames.back().frame);
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < replay.frames.size(); ++i) {
    if (replay.frames[i].frame >= first && replay.frames[i].frame <= last) positions.push_back(i);
  }
  if (positions.empty()) {
    throw InputError("no tracked frame between " + std::to_string(first) + " and " +
                     std::to_string(last));
  }
  scene::SnapshotRenderer snapshots(snapshot);
  Playback playback(replay, std::move(truth), replay.frames[positions.front()].frame, note);
  program::VideoOutput video(options.output, rateOf(replay), {snapshot.width, snapshot.height},
                             options.overwrite, note);
  program::catchInterrupts();
  program::Progress progress("drawing", options.quiet);
  for (std::size_t i = 0; i < positions.size() && !program::interrupted(); ++i) {
    video.add(snapshots.draw(playback.at(positions[i])));
    progress.update(i + 1, static_cast<double>(i + 1) / static_cast<double>(positions.size()));
  }
  video.finish();
}

/// The page is made from the folder's files; map and rawlog add keyframes and images.
void writePage(const Options& options, const FinishedReplay& replay, const Note& note) {
  report::ReplayPageOptions page;
  page.truth = options.truth;
  page.output = options.output;
  for (const auto& keyframe : replay.map.staticMap()->keyframes) {
    page.keyframes.push_back({keyframe.time, keyframe.T_map_robot});
  }
  report::RecordedImages images(replay.input, replay.frames.front().frame, note);
  report::PageImages small;
  for (const auto& frame : replay.frames) small.add(frame.frame, images.at(frame.frame));
  page.images = small.jpegs();
  report::writeReplayPage(options.input, page, note);
}

}  // namespace

void render(const Options& options) {
  program::requireWritable(options.output, options.overwrite, {options.input});
  const Note note = [&](const std::string& text) {
    if (!options.quiet) std::cerr << "headway-render: " << text << '\n';
  };
  if (options.kind == OutputKind::kReport) {
    program::writeTruthReport(options.input, options.truth, options.output, "", note);
    return;
  }
  const FinishedReplay replay = readReplay(options.input, note);
  if (options.kind == OutputKind::kReplayPage) return writePage(options, replay, note);
  report::ReplayTruth truth;
  if (!options.truth.empty()) {
    truth = report::readReplayTruth(options.truth, replay.frames, note);
  }
  if (options.kind == OutputKind::kVideo) {
    drawVideo(options, replay, std::move(truth), note);
  } else {
    drawPicture(options, replay, std::move(truth), note);
  }
}

}  // namespace headway::render_program
