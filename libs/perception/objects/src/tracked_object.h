// SPDX-License-Identifier: BSD-3-Clause
// One track: its state, confirmation, coasting and path.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/track.h>
#include <headway/objects/objects_params.h>
#include <headway/objects/predictor.h>

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "consistency.h"
#include "kalman_filter.h"
#include "track_evidence.h"
#include "trajectory.h"

namespace headway::objects {

/// Predicts the image box of an object that moved relative to the camera.
///
/// Needs no calibration: the focal length follows from the heights of the object and of its box,
/// shift and scale from the pinhole model.
///
/// @param box     of the object at `from` [px]
/// @param from    centre in the sensor's optical frame [m]
/// @param to      centre now, same frame [m]
/// @param height  of the object [m]
/// @return        nullopt if the object is not in front of the camera
[[nodiscard]] std::optional<Box2d> predictedBox(const Box2d& box, const Eigen::Vector3d& from,
                                                const Eigen::Vector3d& to, double height);

/// One trajectory S_i and the state of its object.
class TrackedObject {
 public:
  /// @param params, rate  must outlive the object
  TrackedObject(TrackId id, std::size_t frame, Time time, const MeasuredBox& first,
                const ObjectsParams& params, const DetectionRate& rate);

  /// Predicts the state to the time of the next frame.
  void predict(const Transition& transition) {
    filter_.predict(transition, motion_class_.standing());
  }

  /// Updates the state by the detection that continues the track (Sec. III-C2).
  ///
  /// @param all_ran  see Detections::all_detectors_ran
  void update(std::size_t frame, Time time, const MeasuredBox& detection, bool all_ran);

  /// Smooths the path after an update (Sec. III-C1) and classifies the object's motion.
  void refine(Time time, TrajectorySmoother& smoother);

  /// Counts a frame without a detection of the object. One in which the detectors that see it do
  /// not run counts as the next in which they do.
  void miss(bool all_ran);

  [[nodiscard]] TrackId id() const { return id_; }

  /// Predicted place of the next detection.
  [[nodiscard]] ExpectedPlace expected() const;

  /// The object for detectors to search for; nullopt without a detector's evidence of motion.
  [[nodiscard]] std::optional<ExpectedObject> searchable(Time time) const;

  [[nodiscard]] TrackStatus statusAt(Time time) const;
  /// Whether it is published; not after a long time without detection, until it is re-detected.
  [[nodiscard]] bool shown(Time time) const;
  /// Whether it has enough detections for a reliable prediction.
  [[nodiscard]] bool mature() const;
  [[nodiscard]] MotionGroup group() const { return motionGroupOf(class_.assumed()); }
  [[nodiscard]] bool seenAt(Time time) const { return last_seen_ == time; }
  [[nodiscard]] Eigen::Vector3d position() const { return filter_.position(); }
  /// Mean of its detections' scores, with 0 for frames without detection and a few before the
  /// first.
  [[nodiscard]] double score() const;

  /// Input of a predictor at `time`: the smoothed path, extrapolated if it was not observed.
  void historyAt(std::size_t frame, Time time, MotionHistory& history) const;

  /// The object as published, without its predictions.
  [[nodiscard]] Track shownAt(Time time) const;

  /// Box in the image, predicted from the last one if it was not observed.
  ///
  /// @param place  of the object now, in the sensor's optical frame [m]
  [[nodiscard]] std::optional<Box2d> imageBoxAt(Time time, const Eigen::Vector3d& place) const;

  /// Appends the places that left the smoothing window.
  void finalise(std::size_t window, Time time, std::vector<TrackSample>& samples);

 private:
  /// The object as published, without path and predictions.
  [[nodiscard]] Track stateAt(Time time) const;
  void updateHeading(const MeasuredBox& detection);
  void keepEvidence(Time time, const MeasuredBox& detection);
  void confirm(const DetectionEvidence& evidence);
  [[nodiscard]] Eigen::Vector3d positionAt(Time time) const;
  /// Of the place over the ground, errors that detections share included [m^2].
  [[nodiscard]] Eigen::Matrix2d placeCovariance() const {
    return filter_.positionCovariance() + shared_covariance_;
  }
  /// The velocity of a track that is not classified as moving.
  void shrinkVelocity(Track& track) const;

  const ObjectsParams* params_;  ///< of the tracker; not null
  const DetectionRate* rate_;    ///< likewise
  TrackId id_;
  ClassEvidence class_;
  KalmanFilter filter_;
  HeadingEvidence heading_;
  MotionClassifier motion_class_;
  bool velocity_measured_ = false;  ///< by the last detection
  Trajectory trajectory_;
  Eigen::Matrix2d shared_covariance_;  ///< of the last detection's place [m^2]
  Eigen::Vector3d smoothed_offset_ = Eigen::Vector3d::Zero();  ///< of the path's end to the filter
  std::optional<std::int64_t> detector_id_;
  std::optional<GroundVelocity> detected_velocity_;  ///< as last measured by a detector
  std::optional<Time> last_motion_;  ///< when a detector last had evidence of motion
  std::shared_ptr<const AppearanceTemplate> appearance_;
  std::optional<Box2d> box2d_;                            ///< as last observed
  Eigen::Vector3d seen_from_ = Eigen::Vector3d::UnitZ();  ///< the object's position at that time
  double standing_headings_ = 1.0;  ///< number of measurements in the heading of a static object
  double score_sum_ = 0.0;
  int hits_ = 1;
  int misses_ = 0;  ///< consecutive
  int all_misses_ = 0;
  int uncounted_ = 0;               ///< frames since then without the detectors that see it
  bool periodic_ = false;           ///< those of the last detection do not run on each frame
  std::optional<bool> classified_;  ///< by a classifier ever; nullopt: none evaluated its frames
  bool motion_tested_ = false;      ///< in the last detection's frame
  bool confirmed_ = false;
  Time first_seen_;
  Time last_seen_;
};

}  // namespace headway::objects
