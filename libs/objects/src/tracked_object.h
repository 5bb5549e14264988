#pragma once

#include <headway/core/track.h>
#include <headway/objects/objects_params.h>
#include <headway/objects/predictor.h>

#include <array>
#include <vector>

#include "consistency.h"
#include "heading_evidence.h"
#include "kalman_filter.h"
#include "motion_verdict.h"
#include "trajectory.h"

namespace headway::objects {

/// One trajectory S_i with all that is known of its object.
class TrackedObject {
 public:
  TrackedObject(TrackId id, std::size_t frame, Time time, const MeasuredBox& first,
                const ObjectsParams& params);

  /// Carries the object on to the time of the next frame.
  void predict(const Transition& transition) { filter_.predict(transition, verdict_.standing()); }

  /// Takes in the detection that continues the track (Sec. III-C2).
  void update(std::size_t frame, Time time, const MeasuredBox& detection);

  /// Smooths the path after an update (Sec. III-C1) and judges whether the object moves.
  void refine(Time time, const TrajectorySmoother& smoother);

  /// Not seen in a frame that was looked at.
  void miss() {
    ++misses_;
    ++all_misses_;
  }

  /// Where the next detection should be.
  [[nodiscard]] ExpectedPlace expected() const;

  [[nodiscard]] TrackStatus statusAt(Time time) const;
  /// Whether the outside should see it: not when lost for long and only waiting to be re-found.
  [[nodiscard]] bool shown(Time time) const;
  /// Whether it has been seen often enough for its expected place to be trusted.
  [[nodiscard]] bool grown() const;
  [[nodiscard]] MotionGroup group() const { return motionGroupOf(object_class_); }
  [[nodiscard]] bool seenAt(Time time) const { return last_seen_ == time; }
  [[nodiscard]] Eigen::Vector3d position() const { return filter_.position(); }
  /// Mean of its detections' scores; frames unseen, and a few before the first, count as 0.
  [[nodiscard]] double score() const;

  /// What a predictor may know at `time`: the smoothed path, carried on where it was not seen.
  void historyAt(std::size_t frame, Time time, MotionHistory& history) const;

  /// The object as shown to the outside, without its predictions.
  [[nodiscard]] Track shownAt(Time time) const;

  /// Box in the image; where it was not seen, the last one carried on to where it should be now.
  ///
  /// @param place  of the object now, in the sensor's optical frame [m]
  [[nodiscard]] std::optional<Box2d> imageBoxAt(Time time, const Eigen::Vector3d& place) const;

  /// Places that left the smoothing window, as samples.
  void settle(std::size_t window, Time time, std::vector<TrackSample>& samples);

  std::vector<PredictedPath> predictions;  ///< of this frame

 private:
  void updateHeading(const MeasuredBox& detection);
  void voteClass(const MeasuredBox& detection);
  void confirm();
  [[nodiscard]] Eigen::Vector3d positionAt(Time time) const;

  ObjectsParams params_;
  TrackId id_;
  ObjectClass object_class_;
  KalmanFilter filter_;
  HeadingEvidence heading_;
  MotionVerdict verdict_;
  bool velocity_measured_ = false;  ///< by the last detection
  Trajectory trajectory_;
  std::array<double, kObjectClassCount> class_votes_{};
  std::optional<std::int64_t> detector_id_;
  std::optional<Box2d> box2d_;                            ///< as last seen
  Eigen::Vector3d seen_from_ = Eigen::Vector3d::UnitZ();  ///< where the object then was
  double standing_headings_ = 1.0;  ///< measurements in the heading of a standing object
  double score_sum_ = 0.0;
  int hits_ = 1;
  int misses_ = 0;  ///< in a row
  int all_misses_ = 0;
  bool confirmed_ = false;
  Time first_seen_;
  Time last_seen_;
};

}  // namespace headway::objects
