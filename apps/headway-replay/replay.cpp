// SPDX-License-Identifier: BSD-3-Clause
#include "replay.h"

#include <headway/core/error.h>
#include <headway/core/printable.h>
#include <headway/core/processor_time.h>
#include <headway/core/stop_request.h>
#include <headway/io/calibration_file.h>
#include <headway/io/track_file.h>
#include <headway/map/map_file.h>
#include <headway/program/progress.h>

#include <cmath>
#include <cstdio>
#include <iostream>
#include <iterator>
#include <sstream>

#include "messages.h"
#include "results.h"

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
  result.use_laser = params.laser.use && params.grid.every_nth_frame > 0;
  return result;
}

pipeline::PerceptionParams perceptionParams(const Options& options,
                                            pipeline::PerceptionParams params) {
  params.slam.stop = stopRequested;
  return options.realtime > 0.0 ? pipeline::PerceptionParams::live(std::move(params)) : params;
}

std::vector<std::string> inputsOf(const Options& options) {
  return {options.input, options.detections, options.load_map};
}

constexpr std::size_t kMaxSeenTracks = 1000;  // above which ended ones are discarded

std::string textOf(const Params& params) {
  std::ostringstream text;
  params.print(text);
  return text.str();
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

Replay::Replay(const Options& options, const pipeline::PerceptionParams& perception_params,
               const Params& params)
    : Replay(options,
             std::make_unique<RawlogInput>(options.input, sourceOptions(options, perception_params),
                                           options.realtime),
             perception_params, params) {}

Replay::Replay(const Options& options, std::unique_ptr<FrameInput> input,
               const pipeline::PerceptionParams& perception_params, const Params& params)
    : options_(options),
      configuration_(textOf(params)),
      source_(std::move(input)),
      camera_(source_->camera()),
      perception_(
          makePerception(options, camera_, perceptionParams(options, perception_params), gnss_)),
      folder_(options.output, options.overwrite, inputsOf(options), isResult),
      writers_(folder_.path(), camera_),
      checkpoint_(folder_.path(), options.checkpoint_s),
      snapshots_(folder_.path(), static_cast<int>(snapshotsOf(options)),
                 scene::themeFrom(options.theme).value_or(scene::Theme::kDark)),
      retrack_time_s_(perception_params.objects.lifecycle.retrack_time_s) {
  perception_->setLog([this](LogLevel level, const std::string& text) { log(level, text); });
  if (!options.detections.empty()) {
    side_detections_ = io::readDetections(options.detections, summary_.detections_dropped);
  }
  summary_.calibration = source_->calibration();
  if (summary_.calibration && !options_.quiet) printCalibration(*summary_.calibration);
  summary_.rig = perception_->rig();
  if (summary_.rig && !options_.quiet) std::puts(stereo::describe(*summary_.rig).c_str());
  if (camera_ != nullptr) io::writeCalibration(folder_.path() / "calibration.yaml", *camera_);
  writeRecord(perception_params.detection, params);
}

void Replay::process() {
  try {
    processAll();
  } catch (...) {
    failure_ = std::current_exception();
  }
  collectWarnings(last_frame_, true);
  if (source_->truncation()) summary_.ended_early = source_->truncation();
  if (program::interrupted()) summary_.ended_early = "interrupted";
  if (failure_) summary_.ended_early = textOf(failure_);
  endCheckpoint();  // its files are replaced
  perception_->finish();
}

void Replay::processAll() {
  program::Progress progress("replay", options_.quiet || on_frame_ != nullptr);
  const auto feed = source_->makeFeed();
  while (!program::interrupted()) {
    auto frame = feed->next();
    summary_.frames_dropped_late = feed->dropped();
    if (!frame) break;
    if (summary_.frame_ms.empty()) summary_.start_up_s = secondsSinceProcessStart();
    applySideDetections(*frame);
    processFrame(*frame, source_->progress());
    if (checkpoint_.isDue()) writeCheckpoint();
    progress.update(summary_.frame_ms.count(), source_->progress());
  }
}

void Replay::applySideDetections(RecordedFrame& frame) const {
  if (options_.detections.empty()) return;
  const auto side = side_detections_.find(frame.index);
  frame.detections = side != side_detections_.end() ? side->second : Detections();
  frame.detections->time = frame.time;
  frame.detections->T_robot_sensor = robotFromCamera();
}

Pose Replay::robotFromCamera() const {
  return camera_ != nullptr ? camera_->T_robot_cam : robotFromOptical();
}

void Replay::processFrame(const RecordedFrame& frame, double progress) {
  const double cpu_before = processorSeconds();
  StageTimes span;
  const auto watch = span.watch("frame");
  const auto update = processed(frame);
  summary_.last_frame_ms = watch.elapsedMs() + frame.rectify_ms;
  summary_.frame_ms.add(summary_.last_frame_ms);
  summary_.cpu_ms += 1e3 * (processorSeconds() - cpu_before) + frame.rectify_ms;

  last_frame_ = frame.index;
  count(frame, update);
  gnss_.add(frame.gnss);
  collectWarnings(frame.index, false);
  writers_.write(update);
  keepLostImage(frame, update);
  const bool is_live = options_.realtime > 0.0;  // and fuses the dense map all the time
  if (!is_live && snapshots_.isDue(progress)) perception_->updateDenseMap();
  snapshots_.add(*perception_, update, frame, progress);
  if (frame.stereo) {
    const auto& colour = frame.stereo->left_colour;
    images_.add(frame.index, colour.empty() ? frame.stereo->left : colour);
  }
  if (on_frame_) on_frame_(frame, update);
}

pipeline::PerceptionUpdate Replay::processed(const RecordedFrame& frame) {
  try {
    auto update = perception_->process(frame);
    if (const auto* fatal = update.fatalFinding()) throw InputError(fatal->text);
    return update;
  } catch (const InputError& error) {
    throw InputError(source_->name() + ", frame " + std::to_string(frame.index) + ": " +
                     error.what());
  }
}

void Replay::count(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update) {
  if (frame.rectify_ms > 0.0) summary_.stages.add("rectify", frame.rectify_ms);
  summary_.detections_used += update.objects.detections_used;
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
  if (seen_tracks_.size() < kMaxSeenTracks) return;
  for (auto seen = seen_tracks_.begin(); seen != seen_tracks_.end();) {
    const bool has_ended = std::abs(update.time - seen->second.last_seen) > retrack_time_s_;
    summary_.tracks_moving += has_ended && seen->second.was_moving ? 1 : 0;
    seen = has_ended ? seen_tracks_.erase(seen) : std::next(seen);
  }
}

void Replay::collectWarnings(std::size_t frame, bool reader_has_stopped) {
  Warnings warnings = perception_->warnings();
  const auto skipped = reader_has_stopped ? source_->skipped() : source_->skippedNow();
  if (skipped) {
    warnings.merge(source_->warnings());
    const auto bad_samples = skipped->find("bad_imu");
    if (bad_samples != skipped->end()) {
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
  if (summary_.frames == 0 || summary_.frames_tracked > 0 || program::interrupted()) return;
  if (!options_.load_map.empty()) return;  // see warnIfNotRelocalised()
  throw InputError(source_->name() + ": none of " + std::to_string(summary_.frames) +
                   " frames was tracked: " + causeOfNoTracking(summary_.calibration));
}

void Replay::log(LogLevel level, const std::string& text) const {
  if (level == LogLevel::kInfo ? !options_.quiet : level == LogLevel::kDebug && options_.debug) {
    std::puts(text.c_str());
  }
}

void Replay::warn(const std::string& text) const {
  std::cerr << options_.program << ": " << printable(text) << std::endl;
}

}  // namespace headway::replay
