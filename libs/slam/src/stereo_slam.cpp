#include <headway/core/error.h>
#include <headway/slam/stereo_slam.h>

#include <algorithm>
#include <optional>

#include "bundle_adjuster.h"
#include "contrast.h"
#include "dynamic_rejection.h"
#include "frame_tracker.h"
#include "hung_path.h"
#include "local_mapper.h"
#include "loop_closer.h"
#include "map_archive.h"
#include "map_culling.h"
#include "motion_model.h"
#include "shared_view.h"
#include "sparse_map.h"

namespace headway::slam {
namespace {

constexpr int kPyramidLevels = 4;
constexpr int kYoung = 8;  ///< frames in which a map's choice of what stands still may change

/// Covariance of T_a_c from those of T_a_b and T_b_c, errors independent.
///
/// @see Barfoot & Furgale 2014, first order; perturbations act on the right
PoseCovariance compose(const PoseCovariance& of_ab, const Pose& T_b_c,
                       const PoseCovariance& of_bc) {
  const Eigen::Matrix3d R = T_b_c.linear().transpose();
  const Eigen::Vector3d& t = T_b_c.translation();
  PoseCovariance adjoint = PoseCovariance::Zero();
  adjoint.topLeftCorner<3, 3>() = R;
  adjoint.topRightCorner<3, 3>() = -R * crossMatrix(t);
  adjoint.bottomRightCorner<3, 3>() = R;
  return adjoint * of_ab * adjoint.transpose() + of_bc;
}

/// The keyframe that shares most landmarks with another, or the first one where none does.
KeyframeId nearestTo(KeyframeId keyframe, const SparseMap& map) {
  for (const KeyframeId id : map.neighbourhood(keyframe, 2)) {
    if (id != keyframe) return id;
  }
  return map.keyframes().begin()->first;
}

/// Throws InputError unless both images are 8-bit grey and of the camera's size.
void requireImages(const StereoFrame& frame, const StereoCamera& camera) {
  for (const cv::Mat* image : {&frame.left, &frame.right}) {
    if (image->type() == CV_8UC1 && image->cols == camera.width && image->rows == camera.height) {
      continue;
    }
    throw InputError("stereo frame " + std::to_string(frame.index) + ": an image is " +
                     std::to_string(image->cols) + "x" + std::to_string(image->rows) +
                     ", must be 8-bit grey and " + std::to_string(camera.width) + "x" +
                     std::to_string(camera.height) + " as calibrated");
  }
}

/// Pose of the robot at the first frame: level where gravity is known, else identity.
Pose firstRobotPose(const StereoFrame& frame, bool use_imu) {
  Pose pose = Pose::Identity();
  if (use_imu && frame.motion_prior.up_robot) {
    pose.linear() =
        Eigen::Quaterniond::FromTwoVectors(*frame.motion_prior.up_robot, Eigen::Vector3d::UnitZ())
            .toRotationMatrix();
    pose.linear() = expSo3({0.0, 0.0, -yawOf(pose)}) * pose.linear();
  }
  return pose;
}

}  // namespace

class StereoSlam::Implementation {
 public:
  Implementation(std::shared_ptr<const StereoCamera> camera, const SlamParams& params)
      : camera_(std::move(camera)),
        params_(params),
        tracker_(*camera_, params),
        adjuster_(*camera_, params.adjust_in_background),
        mapper_(*camera_, params, adjuster_),
        loops_(*camera_, params, adjuster_),
        motion_(camera_->T_robot_cam, params) {}

  SlamUpdate process(const StereoFrame& frame, const MovingRegions& moving) {
    moveWith(adjuster_.takeOver(map_));
    TrackingFrame current;
    std::optional<TrackedPose> tracked;
    {
      const auto watch = times_.watch("slam_track");
      current = prepare(frame, moving);
      tracked = track(frame, current);
    }
    const auto watch = times_.watch("slam_map");
    const SlamUpdate update = tracked ? accept(current, *tracked) : guess(frame, current);
    path_.add(current.index, current.time, update.status == TrackingStatus::kTracked,
              motion_.last(), reference_, map_);
    if (update.status == TrackingStatus::kTracked) previous_ = std::move(current);
    return update;
  }

  [[nodiscard]] MapView map() const;
  [[nodiscard]] std::string save() const { return packMap(map_, *camera_); }
  void load(const std::string& bytes);
  void finish() { moveWith(adjuster_.finish(map_)); }
  [[nodiscard]] std::vector<FrameEstimate> trajectory() const {
    return path_.estimates(map_, camera_->T_robot_cam.inverse(Eigen::Isometry));
  }
  [[nodiscard]] const StageTimes& times() const { return times_; }

 private:
  [[nodiscard]] TrackingFrame prepare(const StereoFrame& frame, const MovingRegions& moving) const;
  std::optional<TrackedPose> track(const StereoFrame& frame, const TrackingFrame& current);
  SlamUpdate accept(const TrackingFrame& current, TrackedPose& tracked);
  SlamUpdate guess(const StereoFrame& frame, const TrackingFrame& current);
  void chooseReference(const TrackingFrame& current, TrackedPose& tracked, SlamUpdate& update);
  [[nodiscard]] bool isLike(const TrackedPose& tracked, KeyframeId keyframe) const;
  [[nodiscard]] bool covers(const SharedView& view, const TrackedPose& tracked) const;
  [[nodiscard]] int patience() const;
  bool begin(const TrackingFrame& current);
  void makeKeyframe(const TrackingFrame& current, TrackedPose& tracked, SlamUpdate& update);
  void attendTo(KeyframeId keyframe);
  void forgetSince(KeyframeId first, KeyframeId end);
  void remove(KeyframeId keyframe, KeyframeId heir);
  [[nodiscard]] bool isYoung() const { return begun_by_.valid() && frames_since_begin_ < kYoung; }
  void moveWith(const std::optional<Pose>& correction);
  [[nodiscard]] Pose robotAt(const Pose& T_map_cam) const {
    return normalized(T_map_cam * camera_->T_robot_cam.inverse(Eigen::Isometry));
  }
  [[nodiscard]] PoseCovariance robotCovariance(const PoseCovariance& of_camera) const {
    return compose(of_camera, camera_->T_robot_cam.inverse(Eigen::Isometry),
                   PoseCovariance::Zero());
  }

  std::shared_ptr<const StereoCamera> camera_;
  SlamParams params_;
  FrameTracker tracker_;
  BundleAdjuster adjuster_;
  LocalMapper mapper_;
  LoopCloser loops_;
  MotionModel motion_;
  SparseMap map_;
  StageTimes times_;

  TrackingFrame previous_;                              ///< the last one that was tracked
  std::vector<TrackedLandmark> seen_before_;            ///< landmarks of that frame
  std::vector<LandmarkId> local_landmarks_;             ///< those around the newest keyframe
  std::optional<KeyframeId> reference_;                 ///< newest keyframe
  PoseCovariance covariance_ = PoseCovariance::Zero();  ///< of the last camera pose
  int lost_in_a_row_ = 0;
  KeyframeId begun_by_;         ///< first keyframe of the newest part of the map begun here
  int frames_since_begin_ = 0;  ///< tracked ones, of that part
  HungPath path_;
};

TrackingFrame StereoSlam::Implementation::prepare(const StereoFrame& frame,
                                                  const MovingRegions& moving) const {
  requireImages(frame, *camera_);
  TrackingFrame current;
  current.index = frame.index;
  current.time = frame.time;
  current.left = buildPyramid(stretched(frame.left, stretchFor(frame.left)), kPyramidLevels);
  current.right = buildPyramid(stretched(frame.right, stretchFor(frame.right)), kPyramidLevels);
  current.excluded = excludedMask(moving, params_.dynamic_rejection, frame.left.size());
  current.suspect = suspectMask(moving, params_.dynamic_rejection, frame.left.size());
  return current;
}

std::optional<TrackedPose> StereoSlam::Implementation::track(const StereoFrame& frame,
                                                             const TrackingFrame& current) {
  if (!reference_) {
    motion_.reset(frame.time, firstRobotPose(frame, params_.use_imu) * camera_->T_robot_cam);
    if (map_.keyframes().empty()) return std::nullopt;
  }
  const std::vector<Pose> guesses{motion_.predict(frame), motion_.last()};
  auto tracked =
      tracker_.track(previous_, seen_before_, current, guesses, local_landmarks_, isYoung(), map_);
  if (tracked) return tracked;
  KeyframeId recognised;
  tracked = loops_.locate(current, map_, &recognised);
  if (!tracked) return std::nullopt;
  attendTo(recognised);
  if (recognised < begun_by_) begun_by_ = KeyframeId{};  // back where all is settled
  return tracked;
}

/// The pose is known: extend the map where it gets thin.
SlamUpdate StereoSlam::Implementation::accept(const TrackingFrame& current, TrackedPose& tracked) {
  SlamUpdate update;
  update.status = TrackingStatus::kTracked;
  update.inliers = static_cast<int>(tracked.landmarks.size());
  const Keyframe& reference = map_.keyframe(*reference_);
  const Pose T_reference_cam = reference.T_map_cam.inverse(Eigen::Isometry) * tracked.T_map_cam;
  covariance_ = compose(reference.covariance, T_reference_cam, tracked.covariance);
  if (lost_in_a_row_ > 0) {
    motion_.reset(current.time, tracked.T_map_cam);  // from a guess to here is no velocity
  } else {
    motion_.update(current.time, tracked.T_map_cam);
  }
  lost_in_a_row_ = 0;
  ++frames_since_begin_;
  chooseReference(current, tracked, update);
  seen_before_ = std::move(tracked.landmarks);
  update.features = static_cast<int>(seen_before_.size());
  seen_before_.insert(seen_before_.end(), tracked.dissenters.begin(), tracked.dissenters.end());
  update.T_map_robot = robotAt(motion_.last());
  update.covariance = robotCovariance(covariance_);
  return update;
}

/// The pose is not known: go on as before, and begin a new part of the map after a while.
SlamUpdate StereoSlam::Implementation::guess(const StereoFrame& frame,
                                             const TrackingFrame& current) {
  constexpr double kGrowth = 0.01;  ///< variance that each guessed frame adds [m^2], [rad^2]
  SlamUpdate update;
  ++lost_in_a_row_;
  if (reference_) {
    motion_.coast(frame.time, motion_.predict(frame));
    covariance_ += kGrowth * PoseCovariance::Identity();
  }
  const bool wanted = map_.keyframes().empty() || (reference_ && lost_in_a_row_ > patience());
  if (params_.mapping && wanted && begin(current)) {
    lost_in_a_row_ = 0;
    update.status = TrackingStatus::kTracked;
    update.is_keyframe = true;
    update.inliers = update.features = static_cast<int>(seen_before_.size());
  }
  update.T_map_robot = robotAt(motion_.last());
  update.covariance = robotCovariance(covariance_);
  return update;
}

/// A first keyframe at the pose guessed; false, and no change, if the frame shows too little.
bool StereoSlam::Implementation::begin(const TrackingFrame& current) {
  TrackedPose fresh;
  fresh.T_map_cam = motion_.last();
  const KeyframeId id =
      mapper_.insert(current, fresh.T_map_cam, covariance_, fresh.landmarks, map_);
  if (static_cast<int>(fresh.landmarks.size()) < params_.min_inliers) {
    map_.removeKeyframe(id);
    return false;
  }
  loops_.index(id, map_);
  attendTo(id);
  if (isYoung()) forgetSince(begun_by_, id);
  seen_before_ = std::move(fresh.landmarks);
  begun_by_ = id;
  frames_since_begin_ = 0;
  return true;
}

/// Lost frames after which the map is begun anew: no more than the part begun last took to make,
/// for what was lost right after its beginning may never have been right.
int StereoSlam::Implementation::patience() const {
  return begun_by_.valid() ? std::min(params_.restart_after, 1 + frames_since_begin_)
                           : params_.restart_after;
}

/// Removes a part of the map that was given up: its keyframes from `first` up to another.
void StereoSlam::Implementation::forgetSince(KeyframeId first, KeyframeId end) {
  std::vector<KeyframeId> part;
  for (const auto& [id, keyframe] : map_.keyframes()) {
    if (!(id < first) && id < end) part.push_back(id);
  }
  for (const KeyframeId id : part) remove(id, end);
}

/// Keeps to the newest keyframe, goes over to an older one, or makes a new one.
void StereoSlam::Implementation::chooseReference(const TrackingFrame& current, TrackedPose& tracked,
                                                 SlamUpdate& update) {
  if (isLike(tracked, *reference_)) return;
  const KeyframeId window = map_.firstOfNewest(params_.mapping ? params_.window : 0);
  const auto passed = [&](KeyframeId id) { return !window.valid() || id < window; };
  const auto known = nearestView(tracked.landmarks, map_, passed);
  if (known && (!params_.mapping || covers(*known, tracked))) {
    if (known->keyframe != *reference_) attendTo(known->keyframe);
  } else if (params_.mapping) {
    makeKeyframe(current, tracked, update);
  }
}

/// Whether a frame shows most landmarks of a keyframe, and about where that saw them.
bool StereoSlam::Implementation::isLike(const TrackedPose& tracked, KeyframeId keyframe) const {
  const SharedView view = sharedView(keyframe, tracked.landmarks, map_);
  const auto all = static_cast<double>(map_.keyframe(keyframe).landmarks.size());
  return view.landmarks >= params_.keyframe_overlap * all &&
         view.flow_px <= params_.keyframe_flow * camera_->width;
}

/// Whether a place seen before needs no new keyframe: a keyframe saw it from about here, and the
/// frame finds as many landmarks as that did, be they its own or those of other times.
bool StereoSlam::Implementation::covers(const SharedView& view, const TrackedPose& tracked) const {
  const auto all = static_cast<double>(map_.keyframe(view.keyframe).landmarks.size());
  return static_cast<double>(tracked.landmarks.size()) >= params_.keyframe_overlap * all &&
         view.flow_px <= params_.keyframe_flow * camera_->width;
}

void StereoSlam::Implementation::makeKeyframe(const TrackingFrame& current, TrackedPose& tracked,
                                              SlamUpdate& update) {
  update.is_keyframe = true;
  const KeyframeId id =
      mapper_.insert(current, tracked.T_map_cam, covariance_, tracked.landmarks, map_);
  loops_.index(id, map_);
  if (params_.loop_closing) update.loops = loops_.close(current, id, map_);
  motion_.correct(map_.keyframe(id).T_map_cam);
  while (const auto redundant = redundantKeyframe(id, params_.window, map_)) {
    remove(*redundant, nearestTo(*redundant, map_));
  }
  attendTo(id);
}

/// Takes a keyframe out of the map; the frames that hang on it go over to another.
void StereoSlam::Implementation::remove(KeyframeId keyframe, KeyframeId heir) {
  path_.handOn(keyframe, heir, map_);
  loops_.remove(keyframe);
  map_.removeKeyframe(keyframe);
}

/// Tracks against the surroundings of a keyframe from now on.
void StereoSlam::Implementation::attendTo(KeyframeId keyframe) {
  reference_ = keyframe;
  local_landmarks_ = map_.seenBy(map_.neighbourhood(keyframe, params_.window));
}

/// The camera goes where an adjustment took the newest part of the map.
void StereoSlam::Implementation::moveWith(const std::optional<Pose>& correction) {
  if (correction) motion_.correct(normalized(Pose(*correction * motion_.last())));
}

void StereoSlam::Implementation::load(const std::string& bytes) {
  map_ = unpackMap(bytes, *camera_);
  for (const auto& [id, keyframe] : map_.keyframes()) loops_.index(id, map_);
}

MapView StereoSlam::Implementation::map() const {
  MapView view;
  for (const auto& [id, landmark] : map_.landmarks()) {
    const auto& patch = landmark.patch;
    const auto centre = patch.centre.array().round().cast<int>();
    view.landmarks.push_back({id, landmark.position, static_cast<int>(landmark.observations.size()),
                              patch.pixels[centre.y() * ReferencePatch::kSize + centre.x()]});
  }
  for (const auto& [id, keyframe] : map_.keyframes()) {
    view.keyframes.push_back({id, keyframe.frame, keyframe.time, robotAt(keyframe.T_map_cam),
                              robotCovariance(keyframe.covariance), keyframe.landmarks});
  }
  return view;
}

StereoSlam::StereoSlam(std::shared_ptr<const StereoCamera> camera, const SlamParams& params)
    : implementation_(std::make_unique<Implementation>(std::move(camera), params)) {}

StereoSlam::~StereoSlam() = default;

SlamUpdate StereoSlam::process(const StereoFrame& frame, const MovingRegions& moving) {
  return implementation_->process(frame, moving);
}

std::string StereoSlam::save() const { return implementation_->save(); }

void StereoSlam::load(const std::string& bytes) { implementation_->load(bytes); }

MapView StereoSlam::map() const { return implementation_->map(); }

std::vector<FrameEstimate> StereoSlam::trajectory() const { return implementation_->trajectory(); }

void StereoSlam::finish() { implementation_->finish(); }

const StageTimes& StereoSlam::times() const { return implementation_->times(); }

}  // namespace headway::slam
