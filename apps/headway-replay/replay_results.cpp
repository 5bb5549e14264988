// SPDX-License-Identifier: BSD-3-Clause
// What a run leaves: the parts of Replay that write its results, at checkpoints and at its end.
#include <headway/core/error.h>
#include <headway/core/printable.h>
#include <headway/map/map_file.h>
#include <headway/map/map_files.h>
#include <headway/program/picture_files.h>
#include <headway/program/truth_report.h>
#include <headway/report/replay_page.h>

#include <algorithm>
#include <optional>

#include "messages.h"
#include "moved_results.h"
#include "replay.h"

namespace headway::replay {

namespace {

std::string titleOf(const std::filesystem::path& folder) {
  return std::filesystem::weakly_canonical(folder).filename().string();
}

}  // namespace

void Replay::writeCheckpoint() {
  endCheckpoint();
  checkpoint_.write([this] { return checkpointContents(); });
}

CheckpointContents Replay::checkpointContents() {
  CheckpointContents contents;
  contents.T_robot_cam = robotFromCamera();
  contents.map = storedMap();
  contents.summary = summarised();
  contents.summary.ended_early =
      "killed after the checkpoint at frame " + std::to_string(last_frame_);
  contents.trajectory = perception_->trajectorySnapshot();
  contents.logs = writers_.paths();
  return contents;
}

map::StoredMap Replay::storedMap() const {
  map::StoredMap stored = perception_->stored();
  stored.configuration = configuration_;
  if (gnss_.added() == 0) return stored;
  stored.made_attachments[kGnssAttachment] =
      [gnss = gnss_, trajectory = perception_->trajectorySnapshot(), view = stored.map.staticMap()](
          const ByteSink& sink) { sink(gnssBytes(gnss.onMap(trajectory, *view))); };
  return stored;
}

void Replay::endCheckpoint() {
  if (const auto failure = checkpoint_.finish()) warn("no checkpoint: " + *failure);
}

void Replay::writeRecord(const pipeline::DetectionParams& detection, const Params& params) {
  const std::string model = camera_ != nullptr ? pipeline::modelInUse(detection) : "";
  writeRunRecord(folder_.path() / "replay.json", options_, params, summary_.rig, model);
  if (camera_ != nullptr && model.empty() && pipeline::wouldUseModel(detection)) {
    log(LogLevel::kInfo,
        "detector: without a network (doc/detectors.md says where to get one; check it by "
        "headway-replay --check-model FILE, use it by --set dnn.model=FILE or $HEADWAY_MODELS)");
  } else if (!model.empty()) {
    log(LogLevel::kInfo, "detector: network " + printable(model));
  }
}

void Replay::moveInto(const Pose& T_map_run) {
  T_map_run_ = T_map_run;
  snapshots_.move(T_map_run);
}

void Replay::complete() {
  try {
    finish();
  } catch (...) {
    if (!failure_) failure_ = std::current_exception();
  }
  if (failure_ && folder_.hasOldResults()) {
    throw InputError(textOf(failure_) + "; the old results in " + published().string() +
                     " remain, the new ones up to frame " + std::to_string(last_frame_) +
                     " are in " + folder_.path().string());
  }
  if (failure_) std::rethrow_exception(failure_);
  folder_.publish();
  requireTrackedFrames();
  if (source_->truncation()) {
    throw InputError(*source_->truncation() + "; the part before was processed and written to " +
                     published().string());
  }
}

void Replay::finish() {
  std::exception_ptr failure;  // the first failure; the other files are written nevertheless
  const auto attempt = [&failure](const auto& step) {
    try {
      step();
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  };
  attempt([&] {
    writers_.writeSmoothed(perception_->flush());
    writers_.finish();
    if (T_map_run_) moveOnlineResults(folder_.path(), *T_map_run_);
  });
  attempt([&] { writeTrajectory(); });
  if (!failure) attempt([&] { writeGeoFiles(); });
  attempt([&] { writeMap(); });
  warnIfNotRelocalised();
  attempt([&] { snapshots_.finish(*perception_); });
  attempt([&] {
    summary_ = summarised();
    summary_.observations_skipped = source_->skipped();
    writeSummary(folder_.path() / "summary.json", summary_);
  });
  if (!failure) attempt([&] { writePages(); });
  if (failure) std::rethrow_exception(failure);
}

std::vector<std::filesystem::path> Replay::pictures() const {
  std::vector<std::filesystem::path> pictures;
  for (const auto& name : snapshots_.written()) {
    pictures.push_back(published() / "snapshots" / name);
  }
  return pictures;
}

Summary Replay::summarised() const {
  Summary summary = summary_;
  const auto static_map = perception_->map().staticMap();
  summary.keyframes = static_map->keyframes.size();
  summary.landmarks = static_map->landmarks.size();
  summary.submaps = perception_->submapCount();
  for (const auto& [id, seen] : seen_tracks_) summary.tracks_moving += seen.was_moving ? 1 : 0;
  summary.stages.merge(perception_->times());
  summary.laser = perception_->laserCounts();
  summary.rectification = perception_->rectification().value_or("");
  if (const auto skipped = source_->skippedNow()) summary.observations_skipped = *skipped;
  summary.total_s = secondsSinceProcessStart();
  return summary;
}

void Replay::writeTrajectory() {
  TrajectoryWriter writer(folder_.path(), robotFromCamera());
  std::size_t written = 0;
  perception_->visitTrajectory([&](const slam::FrameEstimate& estimate) {
    writer.add(estimate);
    ++written;
  });
  writer.commit();
  const std::size_t processed = summary_.frame_ms.count();
  if (written >= processed) return;
  warn("trajectory.tum lacks " + std::to_string(processed - written) +
       " frames, for which the disk of temporary files had no space; trajectory_online.tum has "
       "them");
}

void Replay::keepLostImage(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update) {
  const bool is_lost = update.camera.status == slam::TrackingStatus::kLost;
  if (!is_lost || !frame.stereo || has_lost_image_) return;
  has_lost_image_ = true;
  try {
    program::writePicture(folder_.path() / "lost.jpg", frame.stereo->left);
  } catch (const InputError& error) {
    warn(error.what());
  }
}

void Replay::writeGeoFiles() {
  if (gnss_.added() == 0) return;
  const auto visit = perception_->trajectorySnapshot();
  summary_.geo = georeferenced(gnss_.onMap(visit, *perception_->map().staticMap()), gnss_.added(),
                               gnss_.kept());
  if (!summary_.geo->reference) return warn(describe(*summary_.geo));
  const auto& reference = *summary_.geo->reference;
  writeTrajectoryGeo(folder_.path() / "trajectory.geojson", reference, visit);
  writeTracksGeo(folder_.path(), reference);
  writeMapGeo(folder_.path() / "map_geo.json", *summary_.geo);
}

void Replay::writeMap() {
  if (summary_.frames == 0) return;
  map::writeMapFiles(folder_.path(), storedMap());
  for (const pipeline::Submap& submap : perception_->otherSubmaps()) {
    const std::string name = "_submap_" + std::to_string(submap.number);
    map::writeMapLayers(folder_.path(), submap.map, name);
    log(LogLevel::kInfo, "submap " + std::to_string(submap.number) + " with " +
                             std::to_string(submap.map.staticMap()->keyframes.size()) +
                             " keyframes, whose place in the map is not known: map_*" + name +
                             ".*");
  }
}

void Replay::writePages() {
  const auto note = [this](const std::string& text) { warn(text); };
  program::writeTruthReport(folder_.path(), options_.truth, {}, titleOf(published()), note);
  if (summary_.frames_tracked == 0) return;  // no trajectory to show
  report::ReplayPageOptions page;
  page.truth = options_.truth;
  page.images = images_.jpegs();
  for (const auto& keyframe : perception_->map().staticMap()->keyframes) {
    page.keyframes.push_back({keyframe.time, keyframe.T_map_robot});
  }
  report::writeReplayPage(folder_.path(), page, note);
}

void Replay::warnIfNotRelocalised() const {
  const bool is_recognised = summary_.frames_tracked > summary_.new_submap_frames.count;
  if (options_.load_map.empty() || is_recognised) return;
  warn("no frame was re-localised in " + options_.load_map +
       ", which may be a map of another place; its landmarks and keyframes are unchanged");
}

}  // namespace headway::replay
