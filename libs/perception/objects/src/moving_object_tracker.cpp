// SPDX-License-Identifier: BSD-3-Clause
// Tracking of moving objects, frame by frame: a track is born in startTracks().
#include <headway/core/pose.h>
#include <headway/objects/moving_object_tracker.h>
#include <headway/objects/predictor.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "consistency.h"
#include "measurement_model.h"
#include "tracked_object.h"

namespace headway::objects {

namespace {

/// Order of preference of tracks: by score, then by the lower id.
struct Candidate {
  Eigen::Vector3d position;
  MotionGroup group;
  double score;
};

/// Suppresses all but the best-scored of tracks of different classes at the same position.
///
/// A detector may detect one person both as a pedestrian and as a cyclist, and each detection
/// starts a separate track.
///
/// @param tracks      in ascending order of ids
/// @param distance_m  below which centres are one position; 0 keeps all [m]
/// @return            those kept, in the same order
std::vector<const TrackedObject*> suppressDuplicateTracks(
    const std::vector<const TrackedObject*>& tracks, double distance_m) {
  if (distance_m <= 0.0) return tracks;
  std::vector<Candidate> candidates;
  candidates.reserve(tracks.size());
  for (const TrackedObject* track : tracks) {
    candidates.push_back({track->position(), track->group(), track->score()});
  }
  const SpatialGrid grid(candidates, distance_m);
  std::vector<const TrackedObject*> kept;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    const Candidate& own = candidates[i];
    bool suppressed = false;
    grid.visitNear(own.position.head<2>(), [&](std::size_t j) {
      const Candidate& other = candidates[j];
      if (other.group == own.group) return;
      const bool better = other.score > own.score || (other.score == own.score && j < i);
      const double distance = (other.position - own.position).head<2>().norm();
      suppressed = suppressed || (better && distance < distance_m);
    });
    if (!suppressed) kept.push_back(tracks[i]);
  }
  return kept;
}

}  // namespace

class MovingObjectTracker::Implementation {
 public:
  explicit Implementation(const ObjectsParams& params)
      : params_(params),
        measurement_(params.consistency, params.filter),
        consistency_(params.consistency),
        smoother_(params.smoothing, rate_),
        predictor_(makePredictor(params.predictor, params.prediction)),
        noise_(params.filter.noise_adaptation) {}

  // Algorithm 1 of the paper, one frame F_k.
  TrackUpdate update(std::size_t frame, const Stamped<Pose>& T_map_robot,
                     const Detections& detections) {
    const Time time = T_map_robot.time;
    TrackUpdate update;
    if (!runsForward(time)) return refuse(frame, detections, std::move(update));
    rate_.add(time);

    const auto measured = measure(T_map_robot.value, detections, update);
    view_.move(T_map_robot.value * detections.T_robot_sensor);
    predictTo(time, update);
    const auto expected = expectedPlaces();
    const Matches matches = consistency_.match(expected, measured.boxes);  // Sec. III-C3
    continueTracks(matches, frame, time, expected, measured,
                   detections.all_detectors_ran);  // Sec. III-C2
    startTracks(matches, frame, time, measured.boxes, update);
    for (const auto& object : objects_) {
      if (object->seenAt(time)) object->refine(time, smoother_);  // Sec. III-C1
    }
    return publish(frame, time, std::move(update));
  }

  TrackUpdate coast(std::size_t frame, Time time) {
    TrackUpdate update;
    if (runsForward(time)) predictTo(time, update);
    return publishAgain(frame, std::move(update));
  }

  std::vector<TrackSample> flush() {
    std::vector<TrackSample> samples;
    for (const auto& object : objects_) object->finalise(0, time_.value_or(0.0), samples);
    objects_.clear();
    return samples;
  }

  std::vector<TrackSample> restart() {
    auto samples = flush();
    time_.reset();
    rate_.restart();
    return samples;
  }

 private:
  [[nodiscard]] bool runsForward(Time time) const {
    return std::isfinite(time) && (!time_ || time > *time_);
  }

  TrackUpdate refuse(std::size_t frame, const Detections& detections, TrackUpdate update) {
    if (!detections.items.empty()) {
      update.detections_dropped["time_backwards"] = detections.items.size();
    }
    return publishAgain(frame, std::move(update));
  }

  // The tracks of the last frame.
  TrackUpdate publishAgain(std::size_t frame, TrackUpdate update) {
    return publish(frame, time_.value_or(0.0), std::move(update));
  }

  DistinctBoxes measure(const Pose& T_map_robot, const Detections& detections,
                        TrackUpdate& update) {
    auto boxes = measurement_.toMap(T_map_robot, detections, update.detections_dropped);
    for (const MeasuredBox& box : boxes) quality_.learn(box);
    for (MeasuredBox& box : boxes) box = quality_.scaled(noise_.scaled(std::move(box)));
    auto measured = consistency_.withoutDuplicates(std::move(boxes));
    if (!measured.duplicates.empty()) {
      update.detections_dropped["duplicate"] = measured.duplicates.size();
    }
    update.detections_used = measured.boxes.size();
    return measured;
  }

  // Predicts every track to the time of F_k; those without detection for too long end.
  void predictTo(Time time, TrackUpdate& update) {
    const double dt = time_ ? time - *time_ : 0.0;
    const Transition transition(dt, params_.filter.acceleration_time_s);
    for (const auto& object : objects_) object->predict(transition);
    time_ = time;
    const auto ended = std::stable_partition(
        objects_.begin(), objects_.end(),
        [&](const auto& object) { return object->statusAt(time) != TrackStatus::kEnded; });
    std::for_each(ended, objects_.end(),
                  [&](const auto& object) { object->finalise(0, time, update.finalised); });
    objects_.erase(ended, objects_.end());
  }

  std::vector<ExpectedPlace> expectedPlaces() const {
    std::vector<ExpectedPlace> places;
    places.reserve(objects_.size());
    for (const auto& object : objects_) places.push_back(object->expected());
    return places;
  }

  void continueTracks(const Matches& matches, std::size_t frame, Time time,
                      const std::vector<ExpectedPlace>& expected, const DistinctBoxes& measured,
                      bool all_ran) {
    for (const auto& [track, detection] : matches.pairs) {
      const MeasuredBox& box = measured.likeliest(detection, expected[track]);
      objects_[track]->update(frame, time, box, all_ran);
      if (objects_[track]->statusAt(time) == TrackStatus::kConfirmed) view_.widenTo(box.position);
      if (objects_[track]->mature()) noise_.learn(expected[track], box);
    }
    for (const auto& object : objects_) {
      if (!object->seenAt(time)) object->miss(all_ran);
    }
  }

  void startTracks(const Matches& matches, std::size_t frame, Time time,
                   const std::vector<MeasuredBox>& measured, TrackUpdate& update) {
    for (const std::size_t detection : matches.unmatched_detections) {
      if (measured[detection].score < params_.lifecycle.start_score) {
        ++update.detections_dropped["low_score"];
        --update.detections_used;
        continue;
      }
      objects_.push_back(std::make_unique<TrackedObject>(TrackId{next_id_++}, frame, time,
                                                         measured[detection], params_, rate_));
    }
  }

  TrackUpdate publish(std::size_t frame, Time time, TrackUpdate update) {
    auto shown = distinctObjects(time);
    const auto beyond = std::remove_if(shown.begin(), shown.end(), [&](const auto* object) {
      return isBeyondRange(object->position());
    });
    if (beyond != shown.end()) {
      update.detections_dropped["track_too_far"] += std::distance(beyond, shown.end());
    }
    shown.erase(beyond, shown.end());
    std::vector<std::vector<PredictedPath>> predictions(shown.size());
    for (std::size_t i = 0; i < shown.size(); ++i) {
      if (shown[i]->statusAt(time) == TrackStatus::kTentative) continue;
      shown[i]->historyAt(frame, time, history_);
      predictor_->predictInto(history_, predictions[i]);  // Sec. III-B
    }
    const auto window =
        static_cast<std::size_t>(rate_.observationsIn(params_.smoothing.window_s)) + 1;
    for (const auto& object : objects_) {
      object->finalise(window, time, update.finalised);
      if (auto expected = object->searchable(time)) update.expected.push_back(std::move(*expected));
    }
    update.tracks.reserve(shown.size());
    for (std::size_t i = 0; i < shown.size(); ++i) {
      Track& track = update.tracks.emplace_back(shown[i]->shownAt(time));
      track.box2d = shown[i]->imageBoxAt(time, view_.inSensor(shown[i]->position()));
      track.predictions = std::move(predictions[i]);  // 8 kB
    }
    return update;
  }

  /// Whether nothing may be said of a place in the map: tracks coast, and their boxes are smoothed.
  [[nodiscard]] bool isBeyondRange(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d seen = view_.inSensor(place);
    return seen.norm() > params_.consistency.max_range_m ||
           seen.z() > params_.consistency.max_depth_m;
  }

  /// The objects that are published, one for each real one.
  [[nodiscard]] std::vector<const TrackedObject*> distinctObjects(Time time) const {
    std::vector<const TrackedObject*> shown;
    shown.reserve(objects_.size());
    for (const auto& object : objects_) {
      if (isShown(*object, time)) shown.push_back(object.get());
    }
    return suppressDuplicateTracks(shown, params_.consistency.duplicate_track_distance_m);
  }

  [[nodiscard]] bool isShown(const TrackedObject& object, Time time) const {
    return object.shown(time) && (object.seenAt(time) || view_.covers(object.position()));
  }

  ObjectsParams params_;
  MeasurementModel measurement_;
  ConsistencyCheck consistency_;
  DetectionRate rate_;  ///< of the frames with detection
  TrajectorySmoother smoother_;
  std::unique_ptr<Predictor> predictor_;
  std::vector<std::unique_ptr<TrackedObject>> objects_;  ///< ascending ids; 2 kB each
  FieldOfView view_;
  NoiseScale noise_;
  ScoreQuality quality_;
  MotionHistory history_;     ///< buffer of one history
  std::optional<Time> time_;  ///< of the last frame
  std::int64_t next_id_ = 0;
};

MovingObjectTracker::MovingObjectTracker(const ObjectsParams& params)
    : implementation_(std::make_unique<Implementation>(validated(params))) {}

MovingObjectTracker::~MovingObjectTracker() = default;

TrackUpdate MovingObjectTracker::update(std::size_t frame, const Stamped<Pose>& T_map_robot,
                                        const Detections& detections) {
  return implementation_->update(frame, T_map_robot, detections);
}

TrackUpdate MovingObjectTracker::coast(std::size_t frame, Time time) {
  return implementation_->coast(frame, time);
}

std::vector<TrackSample> MovingObjectTracker::flush() { return implementation_->flush(); }

std::vector<TrackSample> MovingObjectTracker::restart() { return implementation_->restart(); }

}  // namespace headway::objects
