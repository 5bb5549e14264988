// SPDX-License-Identifier: BSD-3-Clause
// One track: its state, confirmation, coasting and path.
#include "tracked_object.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "recent_motion.h"

namespace headway::objects {

std::optional<Box2d> predictedBox(const Box2d& box, const Eigen::Vector3d& from,
                                  const Eigen::Vector3d& to, double height) {
  constexpr double kMinDepth_m = 0.1;
  if (!(from.z() > kMinDepth_m && to.z() > kMinDepth_m && height > 0.0)) return std::nullopt;
  const double focal_px = box.height() * from.z() / height;
  const double scale = from.z() / to.z();
  const double u =
      0.5 * (box.left + box.right) + focal_px * (to.x() / to.z() - from.x() / from.z());
  const double v =
      0.5 * (box.top + box.bottom) + focal_px * (to.y() / to.z() - from.y() / from.z());
  const double half_width = 0.5 * scale * box.width();
  const double half_height = 0.5 * scale * box.height();
  return Box2d{u - half_width, v - half_height, u + half_width, v + half_height};
}

namespace {

constexpr int kUnclassifiedRatio = 2;  // of hits of a track in which no classifier sees an object

}  // namespace

TrackedObject::TrackedObject(TrackId id, std::size_t frame, Time time, const MeasuredBox& first,
                             const ObjectsParams& params, const DetectionRate& rate)
    : params_(&params),
      rate_(&rate),
      id_(id),
      class_(first),
      filter_(first, params.filter),
      heading_(params.heading),
      motion_class_(params.motion_class),
      shared_covariance_(first.shared_covariance),
      detector_id_(first.detector_id),
      box2d_(first.box2d),
      seen_from_(first.seen_from),
      score_sum_(first.score),
      periodic_(first.evidence.periodic),
      first_seen_(time),
      last_seen_(time) {
  keepEvidence(time, first);
  confirm(first.evidence);
  trajectory_.append(frame, time, first, first.position, first.yaw);
}

void TrackedObject::update(std::size_t frame, Time time, const MeasuredBox& detection,
                           bool all_ran) {
  filter_.updatePlace(detection);
  shared_covariance_ = detection.shared_covariance;
  velocity_measured_ = detection.velocity.has_value();
  if (detection.velocity) filter_.updateVelocity(*detection.velocity);
  filter_.updateSize(detection);
  updateHeading(detection);
  if (all_ran) class_.add(detection);  // else provisional classes would outvote the network's
  keepEvidence(time, detection);
  trajectory_.append(frame, time, detection, filter_.position(), filter_.yaw());
  const int frames = 1 + std::exchange(uncounted_, 0);
  score_sum_ += frames * detection.score;
  hits_ += frames;
  misses_ = 0;
  periodic_ = detection.evidence.periodic;
  if (detection.detector_id) detector_id_ = detection.detector_id;
  box2d_ = detection.box2d;
  seen_from_ = detection.seen_from;
  last_seen_ = time;
  confirm(detection.evidence);
}

void TrackedObject::miss(bool all_ran) {
  ++uncounted_;
  if (periodic_ && !all_ran) return;
  misses_ += uncounted_;
  all_misses_ += uncounted_;
  uncounted_ = 0;
}

// A detection by appearance has neither a new velocity nor a new template.
void TrackedObject::keepEvidence(Time time, const MeasuredBox& detection) {
  if (detection.evidence.motion) {
    last_motion_ = time;
    detected_velocity_ = detection.velocity;
  }
  motion_tested_ = detection.evidence.motion_tested;
  if (detection.evidence.motion) appearance_ = detection.appearance;
}

// A classifier's box that moves is an object at once, as motion shows in several frames only;
// motion in which a classifier sees no object needs more evidence.
void TrackedObject::confirm(const DetectionEvidence& evidence) {
  const LifecycleParams& life = params_->lifecycle;
  if (evidence.classifier_tested) {
    classified_ = classified_.value_or(false) || evidence.classifier;
    confirmed_ = confirmed_ || (evidence.classifier && evidence.motion);
  }
  const int needed_hits =
      (classified_ == false ? kUnclassifiedRatio : 1) * rate_->observationsIn(life.confirm_time_s);
  const double score = score_sum_ * (DetectionRate::kUsual_hz / rate_->hz());
  const bool sure = hits_ >= needed_hits && score >= life.confirm_score.of(group());
  confirmed_ = confirmed_ || sure || hits_ >= rate_->observationsIn(life.confirm_anyway_time_s);
}

// Moving: filtered. Static: the mean of the first measurements, then constant.
void TrackedObject::updateHeading(const MeasuredBox& detection) {
  const double measured = heading_.unflipped(detection.yaw, filter_.yaw());
  const int converged = rate_->observationsIn(params_->heading.converged_time_s);
  if (motion_class_.moving()) {
    filter_.updateYaw(measured, detection.yaw_sigma_rad);
    const Eigen::Vector2d direction = unitOr(filter_.velocity().head<2>(), Eigen::Vector2d::Zero());
    heading_.addMotion(
        direction.dot(Eigen::Vector2d(std::cos(filter_.yaw()), std::sin(filter_.yaw()))));
    standing_headings_ = 0.5 * converged;
  } else if (standing_headings_ < converged) {
    standing_headings_ += 1.0;
    filter_.averageYaw(measured, standing_headings_);
  }
  if (heading_.turnsRound()) {
    filter_.turnRound();
    for (TrajectoryPoint& point : trajectory_.path) point.yaw = wrapAngle(point.yaw + M_PI);
  }
}

void TrackedObject::refine(Time time, TrajectorySmoother& smoother) {
  constexpr double kSpeedWindow_s = 1.0;
  smoother.refine(trajectory_, filter_, group(), mature(), motion_class_.standing());
  smoothed_offset_ = trajectory_.path.back().position - filter_.position();
  auto motion = measuredMotion(trajectory_.measurements, kSpeedWindow_s + kFrameJitter_s);
  if (velocity_measured_) motion = {filter_.velocity().head<2>(), filter_.velocityCovariance()};
  if (!motion) return;
  const Eigen::Vector2d along = unitOr(motion->velocity, Eigen::Vector2d::UnitX());
  motion_class_.update(time, motion->velocity.norm(),
                       std::sqrt(along.dot(motion->covariance * along)), group());
  const bool moved = last_motion_ && time - *last_motion_ < kMotionMemory_s;
  if (motion_tested_ && !moved) motion_class_.setStatic();
}

ExpectedPlace TrackedObject::expected() const {
  return {filter_.position(),
          filter_.positionCovariance(),
          filter_.verticalVariance(),
          class_.assumed(),
          detector_id_,
          id_};
}

std::optional<ExpectedObject> TrackedObject::searchable(Time time) const {
  if (!last_motion_ || !detected_velocity_) return std::nullopt;
  ExpectedObject object;
  object.track = id_;
  object.object_class = class_.assumed();
  object.time = time;
  object.position = filter_.position();
  object.velocity.value << detected_velocity_->value, 0.0;
  object.velocity.covariance.setZero();
  object.velocity.covariance.topLeftCorner<2, 2>() = detected_velocity_->covariance;
  object.observations = hits_;
  object.detector_id = detector_id_;
  object.last_observed = last_seen_;
  object.last_motion = *last_motion_;
  object.appearance = appearance_;
  return object;
}

bool TrackedObject::mature() const {
  return hits_ >= rate_->observationsIn(params_->smoothing.mature_time_s);
}

double TrackedObject::score() const {
  return score_sum_ /
         (hits_ + all_misses_ + rate_->framesIn(params_->lifecycle.score_prior_time_s));
}

TrackStatus TrackedObject::statusAt(Time time) const {
  const LifecycleParams& life = params_->lifecycle;
  const double unseen = time - last_seen_;
  if (!confirmed_) {
    return unseen > life.tentative_time_s ? TrackStatus::kEnded : TrackStatus::kTentative;
  }
  if (unseen <= 0.0) return TrackStatus::kConfirmed;
  return unseen > life.retrack_time_s ? TrackStatus::kEnded : TrackStatus::kCoasting;
}

bool TrackedObject::shown(Time time) const {
  const LifecycleParams& life = params_->lifecycle;
  if (seenAt(time) || !confirmed_) return true;
  const bool is_certain = misses_ == 0 || score() >= life.min_coast_score.of(group());
  return is_certain && time - last_seen_ <= life.coast_time_s + kFrameJitter_s &&
         misses_ <= life.max_coast_ratio * hits_ &&
         meanSigma(filter_.positionCovariance()) <= life.max_coast_sigma_m;
}

// An object that is not seen continues from the smoothed path, so that its position has no step.
Eigen::Vector3d TrackedObject::positionAt(Time time) const {
  return seenAt(time) ? trajectory_.path.back().position : filter_.position() + smoothed_offset_;
}

void TrackedObject::historyAt(std::size_t frame, Time time, MotionHistory& history) const {
  history.object_class = class_.known();
  history.path = trajectory_.path;
  history.position_covariance = placeCovariance();
  if (!seenAt(time)) history.path.push_back({frame, time, positionAt(time), filter_.yaw()});
}

Track TrackedObject::shownAt(Time time) const {
  Track track = stateAt(time);
  track.recent_path = trajectory_.path;
  return track;
}

Track TrackedObject::stateAt(Time time) const {
  Track track;
  track.id = id_;
  track.object_class = class_.known();
  track.status = statusAt(time);
  track.motion_state = motion_class_.state();
  track.score = score();
  track.position = positionAt(time);
  track.velocity = filter_.velocity();
  track.velocity_covariance = filter_.velocityCovariance();
  if (!motion_class_.moving()) shrinkVelocity(track);
  track.yaw = filter_.yaw();
  track.yaw_rate = motion_class_.moving() ? filter_.yawRate() : 0.0;
  track.size = filter_.size();
  track.position_covariance.setZero();
  track.position_covariance.topLeftCorner<2, 2>() = placeCovariance();
  track.position_covariance(2, 2) = filter_.verticalVariance();
  track.first_seen = first_seen_;
  track.last_seen = last_seen_;
  return track;
}

// The estimate with a zero-mean prior, whose sigma is the speed from which such objects count as
// moving. A velocity that contradicts the classification shows that its covariance is too small.
void TrackedObject::shrinkVelocity(Track& track) const {
  const double limit = params_->motion_class.moving_speed_mps.of(group());
  const Eigen::Matrix2d prior = limit * limit * Eigen::Matrix2d::Identity();
  const Eigen::Vector2d velocity = track.velocity.head<2>();
  Eigen::Matrix2d covariance = track.velocity_covariance;
  const double excess = velocity.dot((prior + covariance).inverse() * velocity);
  covariance *= std::max(1.0, excess);
  const Eigen::Matrix2d gain = prior * (prior + covariance).inverse();
  track.velocity.head<2>() = gain * velocity;
  track.velocity.z() *= 0.5 * gain.trace();
  track.velocity_covariance = gain * covariance;
}

std::optional<Box2d> TrackedObject::imageBoxAt(Time time, const Eigen::Vector3d& place) const {
  if (seenAt(time) || !box2d_) return box2d_;
  return predictedBox(*box2d_, seen_from_, place, filter_.size().z());
}

void TrackedObject::finalise(std::size_t window, Time time, std::vector<TrackSample>& samples) {
  if (!confirmed_) {
    (void)trajectory_.finalise(window);
    return;
  }
  if (trajectory_.path.size() <= window) return;
  const Track shown_now = stateAt(time);  // before its path is removed
  const std::vector<TrajectoryPoint> finalised = trajectory_.finalise(window);
  for (std::size_t j = 0; j < finalised.size(); ++j) {
    const TrajectoryPoint& point = finalised[j];
    const TrajectoryPoint& next = j + 1 < finalised.size()    ? finalised[j + 1]
                                  : !trajectory_.path.empty() ? trajectory_.path.front()
                                                              : point;
    TrackSample sample{point.frame, point.time, shown_now};
    sample.track.status = TrackStatus::kConfirmed;
    sample.track.position = point.position;
    sample.track.yaw = point.yaw;
    if (next.time > point.time) {
      sample.track.velocity = (next.position - point.position) / (next.time - point.time);
      sample.track.velocity_covariance = filter_.velocityCovariance();
      if (!motion_class_.moving()) shrinkVelocity(sample.track);
    }
    samples.push_back(std::move(sample));
  }
}

}  // namespace headway::objects
