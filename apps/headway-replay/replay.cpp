#include "replay.h"

#include <headway/core/error.h>
#include <headway/core/processor_time.h>
#include <headway/io/calibration_file.h>
#include <headway/io/track_file.h>
#include <headway/map/map_export.h>
#include <headway/map/map_file.h>
#include <headway/map/static_grid.h>
#include <headway/program/progress.h>
#include <headway/program/truth_report.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <sstream>

#include "messages.h"

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
                                            const pipeline::PerceptionParams& params) {
  return options.realtime > 0.0 ? pipeline::PerceptionParams::live(params) : params;
}

std::string textOf(const Params& params) {
  std::ostringstream text;
  params.print(text);
  return text.str();
}

/// Creates the pipeline with the map of --load-map, if given.
std::unique_ptr<pipeline::Perception> makePerception(
    const Options& options, const std::shared_ptr<const StereoCamera>& camera,
    const pipeline::PerceptionParams& params) {
  auto perception = std::make_unique<pipeline::Perception>(camera, params);
  if (options.load_map.empty()) return perception;
  const auto stored = map::loadMap(options.load_map);
  try {
    perception->resume(stored);
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
      perception_(makePerception(options, camera_, perceptionParams(options, perception_params))),
      folder_(prepareOutputFolder(options.output, options.overwrite)),
      writers_(folder_, camera_),
      snapshots_(folder_, options.snapshots, [this](const std::string& text) { warn(text); }) {
  if (!options.detections.empty()) {
    side_detections_ = io::readDetections(options.detections, summary_.detections_dropped);
  }
  summary_.calibration = source_->calibration();
  if (summary_.calibration && !options_.quiet) printCalibration(*summary_.calibration);
  summary_.rig = perception_->rig();
  if (summary_.rig && !options_.quiet) std::puts(stereo::describe(*summary_.rig).c_str());
  if (camera_ != nullptr) io::writeCalibration(folder_ / "calibration.yaml", *camera_);
  writeRunRecord(folder_ / "replay.json", options_, params, summary_.rig);
}

void Replay::run() {
  std::exception_ptr failure;
  try {
    processAll();
  } catch (...) {
    failure = std::current_exception();
  }
  collectWarnings(last_frame_, true);
  if (source_->truncation()) summary_.ended_early = source_->truncation();
  if (program::interrupted()) summary_.ended_early = "interrupted";
  if (failure) summary_.ended_early = textOf(failure);
  try {
    finish();
  } catch (...) {
    if (!failure) throw;
  }
  if (failure) std::rethrow_exception(failure);
  requireTrackedFrames();
  if (source_->truncation()) {
    throw InputError(*source_->truncation() + "; the part before was processed and written to " +
                     folder_.string());
  }
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
    process(*frame, source_->progress());
    progress.update(summary_.frame_ms.size(), source_->progress());
  }
}

void Replay::applySideDetections(RecordedFrame& frame) const {
  if (options_.detections.empty()) return;
  const auto side = side_detections_.find(frame.index);
  frame.detections = side != side_detections_.end() ? side->second : Detections();
  frame.detections->time = frame.time;
  frame.detections->T_robot_sensor = camera_ != nullptr ? camera_->T_robot_cam : robotFromOptical();
}

void Replay::process(const RecordedFrame& frame, double progress) {
  const double cpu_before = processorSeconds();
  StageTimes span;
  const auto watch = span.watch("frame");
  const auto update = processed(frame);
  summary_.frame_ms.push_back(watch.elapsedMs() + frame.rectify_ms);
  summary_.cpu_ms += 1e3 * (processorSeconds() - cpu_before) + frame.rectify_ms;

  last_frame_ = frame.index;
  count(frame, update);
  collectWarnings(frame.index, false);
  writers_.write(update);
  snapshots_.add(*perception_, update, frame, progress);
  if (on_frame_) on_frame_(frame, update);
}

pipeline::PerceptionUpdate Replay::processed(const RecordedFrame& frame) {
  try {
    return perception_->process(frame);
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
    if (!options_.quiet) std::puts(describe(update.frame, attempt).c_str());
  }
  for (const auto& track : update.objects.tracks) {
    if (track.status == TrackStatus::kConfirmed) {
      bool& ever_moving = seen_tracks_[track.id];
      ever_moving = ever_moving || isMoving(track);
    }
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

void Replay::countLostFrames(const std::vector<slam::FrameEstimate>& trajectory) {
  if (trajectory.empty()) return;
  std::size_t next = trajectory.front().frame;
  for (const auto& estimate : trajectory) {
    while (next < estimate.frame) summary_.lost_frames.push_back(next++);
    if (!estimate.tracked) summary_.lost_frames.push_back(estimate.frame);
    if (estimate.tracked) ++summary_.frames_tracked;
    ++next;
  }
  summary_.frames = next - trajectory.front().frame;
}

void Replay::finish() {
  perception_->finish();
  const auto trajectory = perception_->trajectory();
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
  });
  attempt([&] {
    writeTrajectories(folder_, trajectory,
                      camera_ != nullptr ? camera_->T_robot_cam : robotFromOptical());
  });
  attempt([&] { writeMap(trajectory); });
  warnIfNotRelocalised(trajectory);
  attempt([&] { snapshots_.finish(*perception_); });
  attempt([&] {
    summarise(trajectory);
    writeSummary(folder_ / "summary.json", summary_);
  });
  if (!failure) {  // the report is made from the written files
    attempt([&] {
      program::writeTruthReport(folder_, options_.truth, {},
                                [this](const std::string& text) { warn(text); });
    });
  }
  if (failure) std::rethrow_exception(failure);
}

void Replay::summarise(const std::vector<slam::FrameEstimate>& trajectory) {
  countLostFrames(trajectory);
  const auto static_map = perception_->map().staticMap();
  summary_.keyframes = static_map->keyframes.size();
  summary_.landmarks = static_map->landmarks.size();
  summary_.tracks_confirmed = seen_tracks_.size();
  for (const auto& [id, moving] : seen_tracks_) summary_.tracks_moving += moving ? 1 : 0;
  summary_.stages.merge(perception_->times());
  summary_.laser = perception_->laserCounts();
  summary_.observations_skipped = source_->skipped();
  summary_.total_s = secondsSinceProcessStart();
}

void Replay::writeMap(const std::vector<slam::FrameEstimate>& trajectory) {
  if (trajectory.empty()) return;
  map::StoredMap stored = perception_->stored();
  stored.configuration = configuration_;
  if (const auto grid = stored.map.staticGrid()) map::writeStaticGrid(folder_ / "map_grid", *grid);
  map::writeSimpleMap(folder_ / "map.simplemap", *stored.map.staticMap());
  map::writePly(folder_ / "map_points.ply", *stored.map.staticMap());
  map::saveMap(folder_ / "map.headway", std::move(stored));
}

void Replay::warnIfNotRelocalised(const std::vector<slam::FrameEstimate>& trajectory) const {
  const auto tracked = [](const slam::FrameEstimate& estimate) { return estimate.tracked; };
  if (options_.load_map.empty() || std::any_of(trajectory.begin(), trajectory.end(), tracked)) {
    return;
  }
  warn("no frame was re-localised in " + options_.load_map +
       ", which may be a map of another place; its landmarks and keyframes are unchanged");
}

void Replay::warn(const std::string& text) const {
  std::cerr << "headway-replay: " << text << std::endl;
}

}  // namespace headway::replay
