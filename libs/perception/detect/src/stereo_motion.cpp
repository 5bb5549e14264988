// SPDX-License-Identifier: BSD-3-Clause
// Detection of moving objects by stereo: the steps of one frame are in
// StereoMotion::Implementation::process().
#include <headway/core/appearance.h>
#include <headway/core/statistics.h>
#include <headway/detect/detector.h>
#include <headway/detect/stereo_motion.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/core.hpp>
#include <set>
#include <utility>
#include <vector>

#include "appearance.h"
#include "disparity_drift.h"
#include "empty_space.h"
#include "moving_object_finder.h"
#include "newcomers.h"
#include "point_follower.h"
#include "residual_flow.h"
#include "segment_follower.h"
#include "track_guided_detection.h"
#include "upright_segments.h"

namespace headway::detect {

void StereoMotionParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("max_range_m", max_range_m, 0.0, 200.0, "m",
           "Maximum distance of moving objects; 0: derived from the rig");
  user.add("min_height_m", min_height_m, 0.0, 5.0, "m",
           "Minimum height above ground of points on objects, greater on rough ground; 0: two "
           "thirds of the rig's minimum obstacle height");
  user.add("min_speed_mps", min_speed_mps, 0.05, 20.0, "m/s",
           "Speed below which an object is static; smaller finds slower people and more false "
           "objects");
  user.add("classify", classify,
           "Classify objects by size and speed; false reports every object as Unknown");
  section.add("max_points", max_points, 100, 10000, "", "Maximum points tracked at a time");
  section.add("spacing_px", spacing_px, 4, 64, "px", "Distance between tracked points");
  section.add("window_s", window_s, 0.1, 3.0, "s", "Time window of a point's observations");
  section.add("segment_window_s", segment_window_s, 0.1, 3.0, "s",
              "Time window of a segment's observations");
  section.add("max_height_m", max_height_m, 0.5, 20.0, "m",
              "Maximum height above ground of points on objects");
  section.add("sigma_px", sigma_px, 0.05, 5.0, "px", "Noise of a point's image position");
  section.add("sigma_disparity_px", sigma_disparity_px, 0.05, 5.0, "px",
              "Noise of a point's disparity");
  section.add("significance", significance, 5.0, 1000.0, "",
              "Threshold of a point's motion test, chi-square of 3 degrees of freedom");
  section.add("max_speed_mps", max_speed_mps, 1.0, 200.0, "m/s", "Maximum object speed");
  section.add("min_points", min_points, 2, 50, "", "Minimum points of an object");
  section.add("max_point_distance_m", max_point_distance_m, 0.1, 10.0, "m",
              "Maximum ground distance between neighbouring points of one object");
  section.add("min_moving_ratio", min_moving_ratio, 0.0, 1.0, "",
              "Minimum ratio of moving points within an object's outline");
  section.add("max_segment_range_m", max_segment_range_m, 0.0, 100.0, "m",
              "Maximum distance at which upright segments are tracked as a whole; 0: derived "
              "from the rig");
  section.add("segment_significance", segment_significance, 5.0, 1000.0, "",
              "Threshold of a segment's motion test, chi-square of 2 degrees of freedom");
  section.add("max_moving_ratio", max_moving_ratio, 0.1, 1.0, "",
              "Ratio of moving points above which the camera's motion is rejected as wrong");
}

namespace {

constexpr double kMinImageContrast = 4.0;  // standard deviation of a usable image [grey levels]
constexpr double kMinAgreeing = 0.3;  // ratio of static points that must fit the camera's motion
constexpr int kFewPoints = 12;  // with fewer classified points the camera's motion is not checked
constexpr double kSupportScale = 6.0;
constexpr double kFootRatio = 4.0 / 3.0;  // of the ground's clearance: block matching smears feet
constexpr double kPeopleRatio = 1.4;      // of ranges of people: motion across and along the ray
constexpr double kStartUp = 0.35;  // before it small errors of pose and stereo resemble motion [s]

bool usable(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0] > kMinImageContrast;
}

/// Replaces ranges that are 0 by those of the rig.
StereoMotionParams forRig(StereoMotionParams params, const StereoCamera& camera) {
  stereo::RigAssumptions configured;
  configured.vehicles_to_m = params.max_range_m;
  configured.segments_to_m = params.max_segment_range_m;
  const auto rig = stereo::rigCapability(camera, configured);
  params.max_range_m = rig.vehicles_to_m;
  params.max_segment_range_m = rig.segments_to_m;
  return params;
}

/// Beyond it nothing is detected: what the user allows, and what a depth camera measures [m].
double reachOf(const StereoMotionParams& params, const StereoCamera& camera) {
  double reach = std::numeric_limits<double>::infinity();
  if (params.max_range_m > 0.0) reach = params.max_range_m;
  if (camera.isDepthCamera()) reach = std::min(reach, camera.depth_reach_m);
  return reach;
}

FollowerParams followerParams(const StereoMotionParams& params, double window_s,
                              double people_to_m) {
  const ObservationNoise noise{params.sigma_px, params.sigma_px, params.sigma_disparity_px};
  return {params.max_points,  params.spacing_px,          window_s,
          params.max_range_m, params.max_height_m,        kPeopleRatio * people_to_m,
          params.window_s,    params.max_speed_mps / 2.0, noise};
}

}  // namespace

class StereoMotion::Implementation {
 public:
  Implementation(std::shared_ptr<const StereoCamera> camera, const StereoMotionParams& params)
      : camera_(std::move(camera)),
        params_(forRig(params, *camera_)),
        reach_m_(reachOf(params, *camera_)),
        path_(*camera_, std::hypot(params.sigma_px, 0.3)),
        window_s_(std::max(params_.window_s, params_.segment_window_s)),
        follower_(*camera_,
                  followerParams(params_, window_s_, stereo::rigCapability(*camera_).people_to_m)),
        flow_meter_(*camera_),
        empty_space_(*camera_, params_.max_segment_range_m),
        segments_(*camera_),
        finder_(*camera_, params_) {}

  /// @return  why the frame cannot be used; null if it can
  const char* process(const stereo::FrameContext& context, const std::optional<Pose>& T_map_robot,
                      const std::vector<ExpectedObject>& expected) {
    const StereoFrame& frame = context.frame();
    found_ = emptyDetections(frame);
    offset_evidence_.clear();
    tested_ = false;
    const bool is_pair = frame.disparity.empty();
    if (!usable(frame.left) || (is_pair && !usable(frame.right))) return "unusable_image";
    disparity_ = context.disparity();
    image_ = context.reducedLeft();
    ground_ = context.ground();
    if (ground_) {
      ground_->clearance_m =
          params_.min_height_m > 0.0 ? params_.min_height_m : kFootRatio * ground_->clearance_m;
    }
    if (!T_map_robot) {
      reset();
      return "no_pose";
    }
    if (!path_.empty() && frame.time - path_.timeOf(path_.newest()) > window_s_) {
      reset();  // nothing can be followed from a frame whose pose is no longer kept
    }
    T_map_cam_ = *T_map_robot * camera_->T_robot_cam;
    const int number = path_.advance(frame.time, T_map_cam_);
    path_.removeBefore(path_.firstSince(frame.time - window_s_));
    follower_.follow(context, disparity_, path_);
    segments_.convert(context);
    const char* unsure = classifyPoints() ? nullptr : "camera_motion_unsure";
    ResidualFlow flow = flow_meter_.measure(image_, disparity_, path_);
    if (unsure != nullptr) flow = {};
    if (ground_) {
      const auto standing =
          standingCells(disparity_, *camera_, *ground_, params_.max_segment_range_m);
      const auto is_new = empty_space_.enter(disparity_, standing, *ground_, drift_, path_, up_);
      auto new_ones = newcomers(is_new, standing, disparity_, *camera_, *ground_);
      segments_.follow(segmentsByFlow(disparity_, flow, *camera_, standing, std::move(new_ones)),
                       path_, up_);
    }
    tested_ = unsure == nullptr && frame.time - path_.timeOf(path_.oldest()) > kStartUp;
    if (tested_) detectObjects(expected);
    follower_.replenish(frame, disparity_, ground_, number);
    return unsure;
  }

  /// Of the newest frame.
  [[nodiscard]] const std::vector<stereo::OffsetEvidence>& offsetEvidence() const {
    return offset_evidence_;
  }
  std::size_t takeImplausible() { return finder_.takeImplausible(); }
  std::size_t takeBeyondRange() { return std::exchange(beyond_range_, 0); }

  /// Of the newest frame.
  [[nodiscard]] MotionDetections result() const {
    MotionDetections result;
    result.detections = found_;
    result.tested = tested_;
    if (const double seconds = path_.lastStep_s(); seconds > 0.0) {
      const int now = path_.newest();
      const Pose step = path_.T_cam_world(now) * path_.T_cam_world(now - 1).inverse();
      result.camera_velocity = step.translation() / seconds;
      result.camera_turn_rate = logSo3(step.linear()) / seconds;
    }
    result.max_ahead_s = params_.window_s;
    return result;
  }

 private:
  void reset() {
    path_ = CameraPath(*camera_, std::hypot(params_.sigma_px, 0.3));
    follower_.clear();
    segments_.clear();
    empty_space_.clear();
    flow_meter_.clear();
  }

  /// Refines the camera's motion and classifies every point. @return whether that motion is
  /// reliable
  bool classifyPoints() {
    std::vector<StaticObservation> static_points;
    for (const auto& point : follower_.points()) {
      if (point.group >= 0 || !point.motion) continue;
      if (point.observations.back().frame != path_.newest()) continue;
      static_points.push_back({point.motion->static_point, point.observations.back().uvd});
    }
    const double agreeing = path_.refine(static_points);
    follower_.fitMotions(path_);
    noise_scale_.update(follower_.points(), path_.lastStep_s());
    drift_.update(follower_.points(), path_, *camera_, noise_scale_.value());
    up_ = path_.T_cam_world(path_.newest()).linear().transpose() *
          (ground_ ? ground_->up : stereo::mountedUp(*camera_));
    dropMismatches();
    for (const auto& point : follower_.points()) {
      if (point.motion && point.group < 0) {
        offset_evidence_.push_back(point.motion->offsetEvidence());
      }
    }
    const auto moving = std::count(classes_.begin(), classes_.end(), PointClass::kMoving);
    const auto classified =
        moving + std::count(classes_.begin(), classes_.end(), PointClass::kStatic);
    const bool flooded =
        classified >= kFewPoints &&
        static_cast<double>(moving) > params_.max_moving_ratio * static_cast<double>(classified);
    const bool astray =
        static_cast<int>(static_points.size()) >= kFewPoints && agreeing < kMinAgreeing;
    return !flooded && !astray;
  }

  void dropMismatches() {
    classes_.clear();
    std::vector<PointTrack> kept;
    for (auto& point : follower_.points()) {
      const PointClass point_class = classifyPoint(point, up_, pointClassParams(params_));
      if (point_class == PointClass::kMismatch) continue;
      if (point_class == PointClass::kStatic) point.group = -1;
      classes_.push_back(point_class);
      kept.push_back(std::move(point));
    }
    follower_.points() = std::move(kept);
  }

  /// By motion alone first, then expected objects by less evidence.
  void detectObjects(const std::vector<ExpectedObject>& expected) {
    const MotionFrame frame{
        path_, image_, disparity_, ground_, up_, follower_.points(), classes_, noise_scale_.value(),
        drift_};
    std::vector<MovingObject> objects = finder_.find(frame, segments_.tracks());
    joinPieces(frame, *camera_, objects);
    setGroups(objects);
    const auto missing = withoutFound(searchedObjects(expected, path_, T_map_cam_), objects, path_);
    detectByAppearance(frame, missing, ground_ ? empty_space_.reach() : 0.0, *camera_, objects);
    for (const MovingObject& object : objects) {
      const bool is_beyond = object.extent.box.centre.z() > reach_m_;
      if (is_beyond) {
        ++beyond_range_;
      } else {
        report(object);
      }
    }
  }

  /// Assigns each object to the earlier group of most of its points and segments, or to a new one.
  void setGroups(std::vector<MovingObject>& objects) {
    std::set<std::int64_t> used = {-1};
    for (auto& object : objects) {
      std::map<std::int64_t, int> votes;
      for (const std::size_t i : object.members) ++votes[follower_.points()[i].group];
      for (const auto* segment : object.segments) ++votes[segment->track.group];
      int max_count = 0;
      for (const auto& [group, count] : votes) {
        if (count <= max_count || used.count(group) > 0) continue;
        object.group = group;
        max_count = count;
      }
      if (max_count == 0) object.group = next_group_++;
      used.insert(object.group);
    }
  }

  [[nodiscard]] std::shared_ptr<const AppearanceTemplate> templateFor(
      const MovingObject& object) const {
    if (object.evidence.appearance) return nullptr;  // the track keeps the one it was found by
    auto cut = templateOf(image_, object.extent.cells, disparity_.reduce);
    if (!cut) return nullptr;
    cut->time = path_.timeOf(path_.newest());
    cut->T_map_camera = T_map_cam_;
    cut->box2d = object.extent.box2d;
    cut->box3d = object.extent.box;
    cut->centre_covariance = object.extent.centre_covariance;
    cut->surface = object.extent.surface;
    cut->support = object.points;
    return std::make_shared<const AppearanceTemplate>(std::move(*cut));
  }

  void report(const MovingObject& object) {
    for (const std::size_t i : object.members) follower_.points()[i].group = object.group;
    for (auto* segment : object.segments) segment->track.group = object.group;
    Detection detection;
    detection.evidence = object.evidence;
    detection.searched_track = object.searched_track;
    if (object.group >= 0) detection.detector_id = object.group;
    if (params_.classify) detection.object_class = object.extent.object_class;
    detection.score = 1.0 - std::exp(-object.points / kSupportScale);
    detection.box2d = object.extent.box2d;
    detection.box3d = object.extent.box;
    detection.centre_covariance = object.extent.centre_covariance;
    detection.velocity = rotated(object.velocity, path_.T_cam_world(path_.newest()).linear());
    // Each of the frames that the velocity was measured over reports it again.
    detection.velocity->covariance *= path_.newest() - object.first_frame + 1;
    detection.mask = maskOf(object.extent.cells, disparity_.reduce);
    detection.appearance = templateFor(object);
    found_.items.push_back(std::move(detection));
  }

  std::shared_ptr<const StereoCamera> camera_;
  StereoMotionParams params_;
  double reach_m_;
  std::size_t beyond_range_ = 0;
  Detections found_;  ///< in the newest frame
  stereo::DisparityImage disparity_;
  std::optional<stereo::GroundPlane> ground_;
  cv::Mat image_;  ///< left, on the disparity grid
  CameraPath path_;
  double window_s_;  ///< of observations, of points and of segments [s]
  PointFollower follower_;
  ResidualFlowMeter flow_meter_;
  EmptySpace empty_space_;
  SegmentFollower segments_;
  MovingObjectFinder finder_;
  NoiseScale noise_scale_;
  DisparityDrift drift_;
  std::vector<PointClass> classes_;                      ///< one for each followed point
  std::vector<stereo::OffsetEvidence> offset_evidence_;  ///< of the newest frame
  bool tested_ = false;                                  ///< for objects, the newest frame
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();        ///< of the ground, world of the path
  std::int64_t next_group_ = 0;
  Pose T_map_cam_ = Pose::Identity();  ///< of the newest frame, as given
};

StereoMotion::StereoMotion(std::shared_ptr<const StereoCamera> camera,
                           const StereoMotionParams& params)
    : implementation_(std::make_unique<Implementation>(std::move(camera), validated(params))) {}

StereoMotion::~StereoMotion() = default;
StereoMotion::StereoMotion(StereoMotion&&) noexcept = default;

MotionDetections StereoMotion::detect(const stereo::FrameContext& context,
                                      const std::optional<Pose>& T_map_robot,
                                      const std::vector<ExpectedObject>& expected) {
  const char* reason = implementation_->process(context, T_map_robot, expected);
  MotionDetections result;
  if (reason == nullptr) {
    result = implementation_->result();
  } else {
    ++result.dropped[reason];
  }
  result.static_points = implementation_->offsetEvidence();
  const std::size_t implausible = implementation_->takeImplausible();
  if (implausible > 0) result.dropped["implausible_object"] = implausible;
  const std::size_t beyond_range = implementation_->takeBeyondRange();
  if (beyond_range > 0) result.dropped["too_far"] = beyond_range;
  return result;
}

namespace {

// Points of the camera frame as seen from the camera some time later.
Pose cameraMotion(const MotionDetections& motion, double ahead) {
  Pose T_later_now = Pose::Identity();
  T_later_now.linear() = expSo3(ahead * motion.camera_turn_rate);
  T_later_now.translation() = ahead * motion.camera_velocity;
  return T_later_now;
}

// How far an object's centre moves in the image [px].
cv::Point2d shiftOf(const Detection& object, const Pose& T_later_now, const StereoCamera& camera,
                    double ahead) {
  const Eigen::Vector3d& centre = object.box3d->centre;
  const auto from = project(centre, camera);
  const auto to = project(T_later_now * (centre + ahead * object.velocity->value), camera);
  if (!from || !to) return {};
  return {to->x() - from->x(), to->y() - from->y()};
}

// One cell more each way: landmarks on the outline's corners are the worst.
void draw(const ObjectMask& object, const cv::Point2d& shift, cv::Mat& mask) {
  const cv::Rect image({0, 0}, mask.size());
  const int reduce = object.reduce;
  for (int row = 0; row < object.cells.rows; ++row) {
    for (int column = 0; column < object.cells.cols; ++column) {
      if (object.cells.at<unsigned char>(row, column) == 0) continue;
      const cv::Point cell = object.corner + cv::Point(column, row);
      const cv::Rect square((cell.x - 1) * reduce + cvRound(shift.x),
                            (cell.y - 1) * reduce + cvRound(shift.y), 3 * reduce, 3 * reduce);
      mask(square & image).setTo(255);
    }
  }
}

}  // namespace

MovingRegions MotionDetections::regionsAt(Time at, const StereoCamera& camera) const {
  MovingRegions regions;
  if (!detections || detections->items.empty()) return regions;
  const double ahead = at - detections->time;
  if (ahead > max_ahead_s) return regions;
  const Pose T_later_now = cameraMotion(*this, ahead);
  regions.mask = cv::Mat(camera.height, camera.width, CV_8U, cv::Scalar(0));
  for (const auto& object : detections->items) {
    const cv::Point2d shift = shiftOf(object, T_later_now, camera, ahead);
    const Box2d& box = *object.box2d;
    regions.boxes.push_back(
        {{box.left + shift.x, box.top + shift.y, box.right + shift.x, box.bottom + shift.y}});
    if (object.mask != nullptr) draw(*object.mask, shift, regions.mask);
  }
  return regions;
}

}  // namespace headway::detect
