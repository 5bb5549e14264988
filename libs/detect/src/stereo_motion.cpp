#include <headway/detect/stereo_motion.h>
#include <headway/stereo/reduced_image.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <utility>

#include "blob_follower.h"
#include "body_flow.h"
#include "disparity_offset.h"
#include "mover_finder.h"
#include "mover_recognition.h"
#include "noise_scale.h"
#include "object_identities.h"
#include "point_follower.h"
#include "regions_ahead.h"
#include "residual_flow.h"

namespace headway::detect {
namespace {

constexpr double kLeastContrast = 4.0;  // standard deviation of a usable image [grey levels]
constexpr double kLeastAgreeing = 0.3;  // share of still points that must fit the camera's motion
constexpr int kFewPoints = 12;          // judged; with fewer nothing is said of the camera
constexpr double kLongestGap = 3.0;     // of the window: after it everything is begun anew
constexpr double kPointsOfSureObject = 6.0;
constexpr double kStartUp =
    0.35;  // until then slight errors of pose and stereo pass for motion [s]

bool usable(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0] > kLeastContrast;
}

stereo::DisparityImage withoutOffset(const stereo::DisparityImage& disparity, double offset) {
  stereo::DisparityImage result{disparity.values.clone(), disparity.reduce};
  cv::subtract(disparity.values, offset, result.values, disparity.values > 0.0F);
  cv::max(result.values, 0.0F, result.values);
  return result;
}

FollowerParams followerOf(const StereoMotionParams& params) {
  return {
      params.max_points,  params.spacing_px,   std::max(params.window_s, params.segment_window_s),
      params.max_range_m, params.min_height_m, params.max_height_m};
}

}  // namespace

class StereoMotion::Implementation {
 public:
  Implementation(std::shared_ptr<const StereoCamera> camera, const StereoMotionParams& params,
                 std::shared_ptr<stereo::DisparityMatcher> matcher)
      : camera_(std::move(camera)),
        params_(params),
        matcher_(std::move(matcher)),
        path_(*camera_, std::hypot(params.sigma_px, 0.3)),
        follower_(*camera_, followerOf(params)),
        flow_meter_(*camera_),
        blobs_(*camera_),
        finder_(*camera_, params) {}

  /// @return  why there is nothing to say of this frame; null if there is
  const char* look(const StereoFrame& frame, const std::optional<Pose>& T_map_robot) {
    objects_.clear();
    cells_.clear();
    if (!usable(frame.left) || !usable(frame.right)) return "unusable_image";
    disparity_ = withoutOffset(matcher_->of(frame), offset_.value());
    image_ = stereo::reducedImage(frame.left, disparity_.reduce);
    ground_ = stereo::findGround(disparity_, *camera_, ground_);
    if (!T_map_robot) {
      startAnew();
      return "no_pose";
    }
    if (!path_.empty() &&
        frame.time - path_.timeOf(path_.newest()) > kLongestGap * params_.window_s) {
      startAnew();
    }
    const int number = path_.advance(frame.time, *T_map_robot * camera_->T_robot_cam);
    path_.forgetBefore(
        path_.firstSince(frame.time - std::max(params_.window_s, params_.segment_window_s)));
    follower_.setDisparityOffset(offset_.value());
    follower_.follow(frame, disparity_, path_);
    const char* unsure = judge() ? nullptr : "camera_motion_unsure";
    ResidualFlow flow = flow_meter_.measure(image_, disparity_, path_);
    if (unsure != nullptr) flow = {};
    if (ground_) {
      blobs_.follow(bodiesByFlow(disparity_, flow, *camera_, *ground_, params_.max_segment_range_m),
                    path_, up_);
    }
    if (unsure == nullptr && frame.time - path_.timeOf(path_.oldest()) > kStartUp) {
      reportMovers();
    }
    follower_.replenish(frame, disparity_, ground_, number);
    return unsure;
  }

  std::size_t takeImplausible() { return finder_.takeImplausible(); }

  [[nodiscard]] MovingRegions regions(Time at) const {
    const double ahead = objects_.empty() ? 0.0 : at - path_.timeOf(path_.newest());
    if (objects_.empty() || ahead > params_.window_s) return {};
    return regionsAhead(objects_, cells_, disparity_.reduce, path_, *camera_, ahead);
  }

  std::vector<MovingObject> objects_;
  stereo::DisparityImage disparity_;
  std::optional<stereo::GroundPlane> ground_;

 private:
  void startAnew() {
    path_ = CameraPath(*camera_, std::hypot(params_.sigma_px, 0.3));
    follower_.clear();
    blobs_.clear();
    flow_meter_.clear();
    identities_.clear();
  }

  /// Takes out the camera's motion and judges every point. @return false if that cannot be trusted
  bool judge() {
    std::vector<StillSighting> still;
    for (const auto& point : follower_.points()) {
      if (point.object >= 0 || !point.motion) continue;
      if (point.sightings.back().frame != path_.newest()) continue;
      still.push_back({point.motion->still_point, point.sightings.back().uvd});
    }
    const double agreeing = path_.refine(still);
    const SightingNoise noise{params_.sigma_px, params_.sigma_px, params_.sigma_disparity_px};
    auto& points = follower_.points();
    const int first = path_.firstSince(path_.timeOf(path_.newest()) - params_.window_s);
    for (auto& point : points) {
      point.motion = fitMotion(since(first, point.sightings), path_, *camera_, noise,
                               params_.max_speed_mps / 2.0);
    }
    noise_scale_.update(points);
    up_ = path_.T_cam_world(path_.newest()).linear().transpose() *
          (ground_ ? ground_->up : stereo::mountedUp(*camera_));
    dropMismatches();
    offset_.update(points, verdicts_);
    const auto moving = std::count(verdicts_.begin(), verdicts_.end(), PointVerdict::kMoving);
    const auto judged =
        moving + std::count(verdicts_.begin(), verdicts_.end(), PointVerdict::kStill);
    const bool flooded =
        judged >= kFewPoints &&
        static_cast<double>(moving) > params_.max_moving_ratio * static_cast<double>(judged);
    const bool astray = static_cast<int>(still.size()) >= kFewPoints && agreeing < kLeastAgreeing;
    return !flooded && !astray;
  }

  void dropMismatches() {
    verdicts_.clear();
    std::vector<PointTrack> kept;
    for (auto& point : follower_.points()) {
      const PointVerdict verdict = verdictOn(point, up_, verdictParamsOf(params_));
      if (verdict == PointVerdict::kMismatch) continue;
      if (verdict == PointVerdict::kStill) point.object = -1;
      verdicts_.push_back(verdict);
      kept.push_back(std::move(point));
    }
    follower_.points() = std::move(kept);
  }

  /// First what surely moves, then what is known from frames before.
  void reportMovers() {
    identities_.beginFrame(path_.timeOf(path_.newest()));
    const LookedAt looked{path_,      image_,
                          disparity_, ground_,
                          up_,        follower_.points(),
                          verdicts_,  noise_scale_.value()};
    std::vector<Mover> movers = finder_.find(looked, blobs_.tracks());
    std::size_t reported = 0;
    const auto reportNew = [&] {
      for (; reported < movers.size(); ++reported) report(movers[reported]);
    };
    reportNew();
    recogniseBodies(looked, identities_.missing(), blobs_.tracks(), *camera_, movers);
    reportNew();
    recogniseLooks(looked, identities_.missing(), *camera_, movers);
    reportNew();
  }

  /// Ids that the parts of a mover had before, the most frequent first.
  [[nodiscard]] std::vector<std::int64_t> formerIds(const Mover& mover) const {
    if (mover.known_as) return {*mover.known_as};
    std::map<std::int64_t, int> votes;
    for (const std::size_t i : mover.members) ++votes[follower_.points()[i].object];
    for (const auto* body : mover.bodies) ++votes[body->track.object];
    votes.erase(-1);
    std::vector<std::int64_t> ids;
    for (const auto& [id, count] : votes) ids.push_back(id);
    std::stable_sort(ids.begin(), ids.end(), [&](auto a, auto b) { return votes[a] > votes[b]; });
    return ids;
  }

  void remember(const Mover& mover, std::int64_t id) {
    auto appearance = appearanceOf(image_, mover.extent.cells);
    if (!appearance) return identities_.remember(id, std::nullopt);
    const int newest = path_.newest();
    identities_.remember(
        id, MoverLook{std::move(*appearance), mover.extent, path_.T_cam_world(newest).inverse(),
                      path_.timeOf(newest), mover.points});
  }

  void report(const Mover& mover) {
    const Pose& T_cam_world = path_.T_cam_world(path_.newest());
    const Eigen::Vector3d& centre = mover.extent.box.centre;
    const ObjectIdentity& identity =
        identities_.identify({formerIds(mover), T_cam_world.inverse() * centre, mover.velocity,
                              recognitionGate(centre.z()), mover.extent.object_class,
                              mover.evidence == MoverEvidence::kMotion});
    for (const std::size_t i : mover.members) follower_.points()[i].object = identity.id;
    for (auto* body : mover.bodies) body->track.object = identity.id;
    if (mover.evidence != MoverEvidence::kLook) remember(mover, identity.id);
    if (identity.sightings < params_.confirm_frames) return;
    MovingObject object;
    object.id = identity.id;
    object.velocity = path_.R_map_world() * mover.velocity.value;
    object.points = mover.points;
    Detection& detection = object.detection;
    if (params_.classify) detection.object_class = identity.objectClass();
    detection.score = 1.0 - std::exp(-mover.points / kPointsOfSureObject);
    detection.detector_id = identity.id;
    detection.box2d = mover.extent.box2d;
    detection.box3d = mover.extent.box;
    detection.centre_covariance = mover.extent.centre_covariance;
    detection.velocity = rotated(mover.velocity, T_cam_world.linear());
    // All those frames tell of it, and each frame's report does so again.
    detection.velocity->covariance *= path_.newest() - mover.first_frame + 1;
    cells_.push_back(mover.extent.cells);
    objects_.push_back(std::move(object));
  }

  std::shared_ptr<const StereoCamera> camera_;
  StereoMotionParams params_;
  cv::Mat image_;  ///< left, on the disparity grid
  std::shared_ptr<stereo::DisparityMatcher> matcher_;
  CameraPath path_;
  PointFollower follower_;
  ResidualFlowMeter flow_meter_;
  BlobFollower blobs_;
  MoverFinder finder_;
  DisparityOffset offset_;
  NoiseScale noise_scale_;
  std::vector<PointVerdict> verdicts_;             ///< one for each followed point
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();  ///< of the ground, world of the path
  ObjectIdentities identities_;
  std::vector<std::vector<cv::Point>> cells_;  ///< of each object
};

StereoMotion::StereoMotion(std::shared_ptr<const StereoCamera> camera,
                           const StereoMotionParams& params,
                           std::shared_ptr<stereo::DisparityMatcher> matcher)
    : implementation_(std::make_unique<Implementation>(std::move(camera), validated(params),
                                                       std::move(matcher))) {}

StereoMotion::~StereoMotion() = default;

std::optional<Detections> StereoMotion::detect(const StereoFrame& frame,
                                               const std::optional<Pose>& T_map_robot) {
  const char* reason = implementation_->look(frame, T_map_robot);
  drop("implausible_object", implementation_->takeImplausible());
  if (reason != nullptr) {
    drop(reason);
    return std::nullopt;
  }
  Detections detections = emptyDetections(frame);
  for (const auto& object : implementation_->objects_) detections.items.push_back(object.detection);
  return detections;
}

MovingRegions StereoMotion::movingRegions(Time at) const { return implementation_->regions(at); }
const std::vector<MovingObject>& StereoMotion::objects() const { return implementation_->objects_; }
const std::optional<stereo::GroundPlane>& StereoMotion::ground() const {
  return implementation_->ground_;
}

}  // namespace headway::detect
