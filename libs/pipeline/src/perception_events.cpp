// SPDX-License-Identifier: BSD-3-Clause
// The parts of Perception that inform its host: log, callbacks, parameters at run time.
#include <headway/pipeline/perception.h>
#include <mrpt/core/exceptions.h>

#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace headway::pipeline {
namespace {

std::string describe(const slam::LoopAttempt& loop) {
  const char* outcome = "closed";
  if (loop.outcome == slam::LoopOutcome::kNotRecognised) outcome = "not recognised";
  if (loop.outcome == slam::LoopOutcome::kTooFewInliers) outcome = "rejected: too few inliers";
  if (loop.outcome == slam::LoopOutcome::kTooFarOff) outcome = "rejected: offset too large";
  char text[200];
  std::snprintf(text, sizeof text, "loop to keyframe %lld %s: inliers %d, required %d",
                static_cast<long long>(loop.candidate.value), outcome, loop.inliers,
                loop.inliers_needed);
  if (loop.offset_allowed_m == 0.0) return text;
  char offset[100];
  std::snprintf(offset, sizeof offset, "; offset %.2f m, allowed %.2f m", loop.offset_m,
                loop.offset_allowed_m);
  return std::string(text) + offset;
}

/// Place of the map that a relocalised camera is at.
std::string describeNearestKeyframe(const slam::MapView& map, const Pose& T_map_robot) {
  const slam::KeyframeView* nearest = nullptr;
  double distance = std::numeric_limits<double>::infinity();
  for (const auto& keyframe : map.keyframes) {
    const double d = (keyframe.T_map_robot.translation() - T_map_robot.translation()).norm();
    if (d < distance) {
      distance = d;
      nearest = &keyframe;
    }
  }
  if (nearest == nullptr) return "in a new map";
  char text[100];
  std::snprintf(text, sizeof text, "%.2f m from keyframe %lld (frame %zu)", distance,
                static_cast<long long>(nearest->id.value), nearest->frame);
  return text;
}

}  // namespace

void Perception::setLog(LogSink sink) { log_ = std::move(sink); }

void Perception::setCallbacks(PerceptionCallbacks callbacks) { callbacks_ = std::move(callbacks); }

void Perception::change(const RuntimeParams& params) {
  ASSERTMSG_(params.detect_every_nth_frame >= 1 && params.grid_every_nth_frame >= 0 &&
                 params.recorded_timeout_s > 0.0 && params.max_box_range_m > 0.0,
             "parameters at run time are out of range");
  const std::lock_guard lock(change_mutex_);
  change_ = params;
}

void Perception::applyChange() {
  const std::lock_guard lock(change_mutex_);
  if (!change_) return;
  detection_.change(change_->detect_every_nth_frame, change_->recorded_timeout_s);
  max_box_range_m_ = change_->max_box_range_m;
  if (mapping_) grid_params_.every_nth_frame = change_->grid_every_nth_frame;
  change_.reset();
}

void Perception::log(LogLevel level, std::size_t frame, const std::string& text) const {
  if (log_) log_(level, "frame " + std::to_string(frame) + ": " + text);
}

void Perception::logLocalisation(const RecordedFrame& frame, const slam::SlamUpdate& camera) {
  const bool is_tracked = camera.status == slam::TrackingStatus::kTracked;
  const bool is_lost = camera.status == slam::TrackingStatus::kLost;
  if (is_lost && frame.stereo && isLocalisedBySlam(frame)) {
    ++lost_frames_;
    if (was_tracked_ || resumed_) {  // otherwise it is not lost, but not localised so far
      const LostReason reason = lost_diagnosis_.reasonOf(*frame.stereo);
      addWarning(std::string("lost_") + toString(reason), frame.index,
                 "the camera is lost: " + explanationOf(reason), warnings_);
    }
  } else if (is_tracked) {
    was_tracked_ = true;
    if (frame.stereo) lost_diagnosis_.addTracked(*frame.stereo);
    if (lost_frames_ > 0 && log_) {
      char offset[64];
      std::snprintf(offset, sizeof offset, ", %.2f m from the predicted position",
                    (camera.T_map_robot.translation() - last_position_).norm());
      log(LogLevel::kInfo, frame.index,
          "localised again after " + std::to_string(lost_frames_) + " lost frames, " +
              describeNearestKeyframe(*map_.staticMap(), camera.T_map_robot) + offset);
    }
    lost_frames_ = 0;
  }
  last_position_ = camera.T_map_robot.translation();
  if (callbacks_.on_pose) callbacks_.on_pose(frame.time, camera);
}

void Perception::logFrame(const PerceptionUpdate& update, const Warnings& before) {
  if (!log_) return;
  for (const auto& [name, warning] : warnings_) {
    if (before.count(name) == 0) log(LogLevel::kWarn, update.frame, warning.text);
  }
  for (const auto& loop : update.camera.loops) log(LogLevel::kInfo, update.frame, describe(loop));
  if (update.camera.map_corrected) log(LogLevel::kInfo, update.frame, "a loop corrected the map");
  char text[200];
  std::snprintf(text, sizeof text,
                "%s, %d landmarks%s; %zu boxes, %zu used; %zu tracks, %zu finalised samples",
                slam::toString(update.camera.status), update.camera.inliers,
                update.camera.is_keyframe ? ", keyframe" : "",
                update.detections ? update.detections->items.size() : 0,
                update.objects.detections_used, update.objects.tracks.size(),
                update.objects.finalised.size());
  std::string line = text;
  for (const auto& [reason, count] : update.objects.detections_dropped) {
    line += "; dropped " + std::to_string(count) + " " + reason;
  }
  log(LogLevel::kDebug, update.frame, line);
}

void Perception::callBack(const PerceptionUpdate& update, const map::PerceptionMap& before) const {
  if (callbacks_.on_tracks) callbacks_.on_tracks(update.time, update.objects.tracks);
  const bool has_changed = map_.staticMap() != before.staticMap() ||
                           map_.staticGrid() != before.staticGrid() ||
                           map_.dense() != before.dense();
  if (has_changed && callbacks_.on_map) callbacks_.on_map(map_);
}

}  // namespace headway::pipeline
