// SPDX-License-Identifier: BSD-3-Clause
// A run over a rawlog or live sensors, with its folder of results.
#include "replay.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/core/worker_thread.h>
#include <headway/io/calibration_file.h>
#include <headway/io/track_file.h>
#include <headway/map/map_export.h>
#include <headway/map/map_file.h>
#include <headway/program/command_line.h>
#include <headway/program/picture_files.h>
#include <headway/program/truth_report.h>
#include <headway/report/replay_page.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <optional>

namespace headway::replay {
namespace {

io::RawlogSourceOptions sourceOptions(const Options& options,
                                      const pipeline::PerceptionParams& params) {
  io::RawlogSourceOptions result;
  result.sensor_label = options.sensor_label;
  result.from_index = options.from_index.value_or(0);
  result.to_index = options.to_index;
  result.use_odometry = params.slam.use_odometry;
  result.use_imu = params.slam.use_imu;
  result.use_laser = params.laser.use && params.grid.period_s > 0.0;
  return result;
}

pipeline::PerceptionParams perceptionParams(const Options& options,
                                            pipeline::PerceptionParams params) {
  params.slam.stop = stopRequested;
  const bool drives = options.is_live || options.realtime > 0.0;
  if (!drives) params.grid.local = false;  // nobody asks what is blocked now
  return options.realtime > 0.0 ? pipeline::PerceptionParams::live(std::move(params)) : params;
}

std::unique_ptr<run::Source> sourceOf(const Options& options,
                                      const pipeline::PerceptionParams& params) {
  auto frames = std::make_unique<run::RawlogFrames>(options.input, sourceOptions(options, params));
  if (!(options.realtime > 0.0)) return frames;
  return run::inRealtime(std::move(frames), options.realtime);
}

pipeline::RuntimeParams runtimeParams(const pipeline::PerceptionParams& params) {
  pipeline::RuntimeParams result;
  result.detect_period_s = params.detection.detect.period_s;
  result.grid_period_s = params.grid.period_s;
  result.recorded_timeout_s = params.detection.recorded_timeout_s;
  return result;
}

run::SessionOptions sessionOptions(const Options& options, const pipeline::PerceptionParams& params,
                                   std::function<void(RecordedFrame&)> prepare) {
  run::SessionOptions result;
  result.stop = program::interrupted;
  result.end_at_fatal_finding = true;
  if (options.is_live) result.shed_load = runtimeParams(params);
  result.prepare = std::move(prepare);
  return result;
}

/// Prints the calibration's consistency with the images to standard output.
void printCalibration(const io::CalibrationReport& report) {
  if (report.is_depth_camera) {
    std::printf("depth camera: focal length %.2f px%s; depth in %.0f %% of the first image\n",
                report.focal_px, report.rectified_here ? " (rectified here)" : "",
                100.0 * report.depth_ratio);
    return;
  }
  std::printf(
      "calibration: baseline %.4f m, focal length %.2f px%s; vertical disparity %.2f px, "
      "median disparity %.1f px (%zu matches)\n",
      report.baseline_m, report.focal_px, report.rectified_here ? " (rectified here)" : "",
      report.vertical_disparity_px, report.median_disparity_px, report.matches);
}

/// Why no frame of a recording was tracked, as far as the first pair shows it, by limits that are
/// far from the values of usable recordings.
std::string causeOfNoTracking(const std::optional<io::CalibrationReport>& calibration) {
  std::string cause = "too few points of the images were tracked";
  if (calibration && calibration->is_depth_camera) {
    if (calibration->depth_ratio < 0.1) {
      cause = "only " + std::to_string(std::lround(100.0 * calibration->depth_ratio)) +
              " % of the first image have depth; check the depth camera's projector, its reach and "
              "the unit of its images (rangeUnits)";
    }
  } else if (calibration && calibration->matches < 20) {
    cause = "only " + std::to_string(calibration->matches) +
            " points of the first left image were found in the right one; check focus, exposure "
            "and lens covers, and that both images are of one stereo pair";
  } else if (calibration && calibration->vertical_disparity_px > 2.0) {
    cause = "the rows of the images differ by " +
            std::to_string(calibration->vertical_disparity_px) + " px; calibrate the cameras";
  } else if (calibration && std::abs(calibration->median_disparity_px) < 0.1) {
    cause =
        "left and right images show the same, at a disparity of 0 px; check that the right "
        "camera was recorded";
  }
  return cause;
}

/// Creates the pipeline with the map of --load-map, if given, and loads its satellite fixes.
std::unique_ptr<pipeline::Perception> makePerception(
    const Options& options, const std::shared_ptr<const StereoCamera>& camera,
    const pipeline::PerceptionParams& params, GnssLog& gnss) {
  auto perception = std::make_unique<pipeline::Perception>(camera, params);
  if (options.load_map.empty()) return perception;
  const auto stored = map::loadMap(options.load_map);
  try {
    perception->resume(stored);
    const auto fixes = stored.attachments.find(kGnssAttachment);
    if (fixes != stored.attachments.end()) gnss.load(fixes->second, *stored.map.staticMap());
  } catch (const InputError& error) {
    throw InputError(options.load_map + ": cannot be continued: " + error.what());
  }
  return perception;
}

}  // namespace

void checkDetector(const std::string& names) {
  try {
    pipeline::checkDetectorNames(names);
  } catch (const InputError& error) {
    throw program::UsageError(std::string("--detector: ") + error.what());
  }
}

Replay::Replay(const Options& options, const pipeline::PerceptionParams& perception_params,
               const Params& params)
    : Replay(options, sourceOf(options, perception_params), perception_params, params) {}

Replay::Replay(const Options& options, std::unique_ptr<run::Source> source,
               const pipeline::PerceptionParams& perception_params, const Params& params)
    : options_(options),
      configuration_(program::textOf(params)),
      source_(std::move(source)),
      perception_(makePerception(options, source_->camera(),
                                 perceptionParams(options, perception_params), gnss_)),
      folder_(options.output, options.overwrite,
              {options.input, options.detections, options.load_map}, program::isResult),
      writers_(folder_.path()),
      checkpoint_(
          folder_.path(), options.checkpoint_s, [this] { return checkpointContents(); },
          [this](const std::string& text) { warn(text); }),
      snapshots_(folder_.path(), static_cast<int>(snapshotsOf(options)),
                 scene::themeFrom(options.theme).value_or(scene::Theme::kDark)),
      retrack_time_s_(perception_params.objects.lifecycle.retrack_time_s),
      session_(*source_, *perception_, {this, &checkpoint_},
               sessionOptions(options, perception_params,
                              [this](RecordedFrame& frame) { prepare(frame); })) {
  perception_->setLog([this](LogLevel level, const std::string& text) { log(level, text); });
  if (!options.detections.empty()) {
    side_detections_ = io::readDetections(options.detections, summary_.detections_dropped);
  }
  summary_.calibration = source_->calibration();
  if (summary_.calibration && !options_.quiet) printCalibration(*summary_.calibration);
  summary_.rig = perception_->rig();
  if (summary_.rig && !options_.quiet) std::puts(stereo::describe(*summary_.rig).c_str());
  writeCalibration();
  summary_.detector = perception_params.detection.detector;
  for (const auto& name : pipeline::imageDetectors(perception_params.detection)) {
    summary_.image_detectors += (summary_.image_detectors.empty() ? "" : "+") + name;
  }
  writeRecord(perception_params.detection, params);
}

void Replay::process() {
  progress_.emplace("replay", options_.quiet || options_.is_live);
  session_.process();
}

void Replay::prepare(RecordedFrame& frame) {
  if (summary_.frame_ms.empty()) summary_.start_up_s = secondsSinceProcessStart();
  if (options_.detections.empty()) return;
  const auto side = side_detections_.find(frame.index);
  frame.detections = side != side_detections_.end() ? side->second : Detections();
  frame.detections->time = frame.time;
  const auto camera = source_->camera();  // as the other boxes of the recording
  frame.detections->T_robot_sensor = camera != nullptr ? camera->T_robot_cam : robotFromOptical();
}

Pose Replay::robotFromCamera() const {
  const auto camera = perception_->camera();
  return camera != nullptr ? camera->T_robot_cam : robotFromOptical();
}

void Replay::writeCalibration() const {
  const auto camera = perception_->camera();
  if (camera != nullptr) io::writeCalibration(folder_.path() / "calibration.yaml", *camera);
}

void Replay::onFrame(const run::FrameResult& result, pipeline::Perception& perception) {
  const RecordedFrame& frame = result.frame;
  summary_.last_frame_ms = 1e3 * result.process_s() + frame.rectify_ms;
  summary_.frame_ms.add(summary_.last_frame_ms);
  summary_.cpu_ms += 1e3 * result.processor_s + frame.rectify_ms;
  last_frame_ = frame.index;
  has_advanced_ = has_advanced_ || (last_time_ && frame.time > *last_time_);
  last_time_ = frame.time;
  count(frame, result.update);
  gnss_.add(frame.gnss);
  collectWarnings(frame.index, result.source);
  if (!result.load_change.empty()) {
    warn("frame " + std::to_string(frame.index) + ": " + result.load_change);
  }
  writers_.write(result.update, perception.camera().get());
  keepLostImage(frame, result.update);
  const bool is_live = options_.realtime > 0.0;  // and fuses the dense map all the time
  if (!is_live && snapshots_.isDue(result.source.progress)) perception.updateDenseMap();
  snapshots_.add(perception, result.update, frame, result.source.progress);
  if (frame.stereo) {
    const auto& colour = frame.stereo->left_colour;
    images_.add(frame.index, colour.empty() ? frame.stereo->left : colour);
  }
  progress_->update(result.frames, result.source.progress);
}

void Replay::onEnd(const std::optional<std::string>& failure) {
  progress_.reset();
  const run::SourceReport source = source_->report();
  summary_.frames_dropped_late = source.dropped;
  collectWarnings(last_frame_, source);
  if (source.truncation) summary_.ended_early = source.truncation;
  if (program::interrupted()) summary_.ended_early = "interrupted";
  if (failure) summary_.ended_early = failure;
}

void Replay::count(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update) {
  if (frame.rectify_ms > 0.0) summary_.stages.add("rectify", frame.rectify_ms);
  summary_.detections_used += update.objects.detections_used;
  summary_.has_recorded_boxes = summary_.has_recorded_boxes || frame.detections.has_value();
  for (const auto& [reason, dropped] : update.objects.detections_dropped) {
    summary_.detections_dropped[reason] += dropped;
  }
  for (const slam::LoopAttempt& attempt : update.camera.loops) {
    summary_.loops += attempt.outcome == slam::LoopOutcome::kClosed ? 1 : 0;
  }
  countFrame(frame.index, update.camera.status);
  countTracks(update);
}

void Replay::countFrame(std::size_t frame, slam::TrackingStatus status) {
  if (!next_frame_) next_frame_ = frame;
  FrameList& missing = source_->dropsLateFrames() ? summary_.late_frames : summary_.lost_frames;
  for (; *next_frame_ < frame; ++*next_frame_, ++summary_.frames) missing.add(*next_frame_);
  if (status == slam::TrackingStatus::kLost) summary_.lost_frames.add(frame);
  if (status == slam::TrackingStatus::kUnreliable) summary_.unreliable_frames.add(frame);
  if (status == slam::TrackingStatus::kTrackedInNewSubmap) summary_.new_submap_frames.add(frame);
  summary_.frames_tracked += slam::isTracked(status) ? 1 : 0;
  ++*next_frame_;
  ++summary_.frames;
}

void Replay::countTracks(const pipeline::PerceptionUpdate& update) {
  for (const auto& track : update.objects.tracks) {
    if (track.status != TrackStatus::kConfirmed) continue;
    const auto [seen, is_new] = seen_tracks_.try_emplace(track.id);
    summary_.tracks_confirmed += is_new ? 1 : 0;
    seen->second.last_seen = update.time;
    seen->second.was_moving = seen->second.was_moving || isMoving(track);
  }
  if (seen_tracks_.size() < 1000) return;  // bounds memory
  for (auto seen = seen_tracks_.begin(); seen != seen_tracks_.end();) {
    const bool has_ended = std::abs(update.time - seen->second.last_seen) > retrack_time_s_;
    summary_.tracks_moving += has_ended && seen->second.was_moving ? 1 : 0;
    seen = has_ended ? seen_tracks_.erase(seen) : std::next(seen);
  }
}

void Replay::collectWarnings(std::size_t frame, const run::SourceReport& source) {
  Warnings warnings = perception_->warnings();
  if (source.skipped) {
    warnings.insert(source.warnings.begin(), source.warnings.end());
    const auto bad_samples = source.skipped->find("bad_imu");
    if (bad_samples != source.skipped->end()) {
      const auto before = summary_.warnings.find("imu_samples");
      addWarning("imu_samples",
                 before == summary_.warnings.end() ? frame : before->second.first_frame,
                 "inertial samples without finite values are left out; check the sensor's driver",
                 warnings, bad_samples->second);
    }
  }
  for (const auto& [name, warning] : warnings) {
    if (summary_.warnings.count(name) > 0) continue;
    warn("frame " + std::to_string(warning.first_frame) + ": " + warning.text);
  }
  summary_.warnings = std::move(warnings);
}

void Replay::requireTrackedFrames() const {
  const std::string name = source_->name();
  const auto& skipped = summary_.observations_skipped;  // of which the reader drops all but one
  const auto back = skipped.find("time_backwards");
  const std::size_t frames = summary_.frames + (back != skipped.end() ? back->second : 0);
  const bool is_one_asked_for =
      options_.to_index && *options_.to_index == options_.from_index.value_or(0);
  if (frames > 1 && !has_advanced_ && !is_one_asked_for) {
    throw InputError(name + ": the times of all " + std::to_string(frames) +
                     " frames are equal or go back; check the clock of their recorder");
  }
  if (summary_.frames_tracked > 0 || (program::interrupted() && !folder_.hasOldResults())) return;
  if (summary_.frames == 0) {
    throw InputError(name +
                     ": none of its frames is in the part that was to be processed; check "
                     "--from-index");
  }
  const std::string cause = options_.load_map.empty()
                                ? causeOfNoTracking(summary_.calibration)
                                : "none was re-localised in " + options_.load_map;
  throw InputError(name + ": none of " + std::to_string(summary_.frames) +
                   " frames was tracked: " + cause);
}

void Replay::log(LogLevel level, const std::string& text) const {
  if (level == LogLevel::kInfo ? !options_.quiet : level == LogLevel::kDebug && options_.debug) {
    std::puts(printable(text).c_str());
  }
}

void Replay::warn(const std::string& text) const {
  std::cerr << options_.program << ": " << printable(text) << std::endl;
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

void Replay::writeRecord(const pipeline::DetectionParams& detection, const Params& params) {
  const bool has_camera = perception_->camera() != nullptr;
  const std::string model = has_camera ? pipeline::modelInUse(detection) : "";
  writeRunRecord(folder_.path() / "replay.json", options_, params, summary_.rig, model);
  if (has_camera && model.empty() && pipeline::wouldUseModel(detection)) {
    log(LogLevel::kInfo,
        "detector: without a network (headway-replay --get-model yolox_nano installs one; see "
        "doc/detectors.md)");
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
    session_.complete();
    requireTrackedFrames();
  } catch (const std::exception& error) {
    if (!folder_.hasOldResults()) throw;
    throw InputError(error.what() + ("; the old results in " + published().string()) +
                     " remain, the new ones up to frame " + std::to_string(last_frame_) +
                     " are in " + folder_.path().string());
  }
  folder_.publish();
  if (const auto truncation = source_->report().truncation) {
    throw TruncatedInput(*truncation + "; the part before was processed and written to " +
                         published().string());
  }
}

void Replay::onComplete(pipeline::Perception& perception) {
  std::exception_ptr failure;  // the first failure; the other files are written nevertheless
  const auto attempt = [&failure](const auto& step) {
    try {
      step();
    } catch (...) {
      if (!failure) failure = std::current_exception();
    }
  };
  attempt([&] {
    writers_.writeSmoothed(perception.flush());
    writers_.finish();
    if (T_map_run_) moveOnlineResults(folder_.path(), *T_map_run_);
  });
  attempt([&] { writeTrajectory(); });
  attempt([&] { writeCalibration(); });
  if (!failure) attempt([&] { writeGeoFiles(); });
  attempt([&] { writeMap(); });
  warnIfNotRelocalised();
  attempt([&] { snapshots_.finish(perception); });
  attempt([&] {
    summary_ = summarised();
    summary_.observations_skipped = source_->report().skipped.value();
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
  summary.rig = perception_->rig();
  summary.rectification = perception_->rectification().value_or("");
  if (const auto skipped = source_->report().skipped) summary.observations_skipped = *skipped;
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
  const std::string title = std::filesystem::weakly_canonical(published()).filename().string();
  const auto report = [&] {
    program::writeTruthReport(folder_.path(), options_.truth, {}, title, note);
  };
  if (summary_.frames_tracked == 0) return report();  // no trajectory to show
  report::ReplayPageOptions page;
  page.truth = options_.truth;
  page.images = images_.jpegs();
  for (const auto& keyframe : perception_->map().staticMap()->keyframes) {
    page.keyframes.push_back({keyframe.time, keyframe.T_map_robot});
  }
  report::writeReplayPage(folder_.path(), page, note);  // an error, if the truth is of another run
  report();
}

void Replay::warnIfNotRelocalised() const {
  const bool is_recognised = summary_.frames_tracked > summary_.new_submap_frames.count;
  if (options_.load_map.empty() || is_recognised) return;
  warn("no frame was re-localised in " + options_.load_map +
       ", which may be a map of another place; its landmarks and keyframes are unchanged");
}

}  // namespace headway::replay
