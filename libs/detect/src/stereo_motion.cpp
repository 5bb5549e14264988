#include <headway/core/box_overlap.h>
#include <headway/detect/stereo_motion.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <utility>

#include "blob_follower.h"
#include "body_motion.h"
#include "disparity_offset.h"
#include "motion_clusters.h"
#include "noise_scale.h"
#include "object_extent.h"
#include "object_identities.h"
#include "over_ground.h"
#include "point_follower.h"
#include "regions_ahead.h"

namespace headway::detect {
namespace {

constexpr double kLeastContrast = 4.0;  // standard deviation of a usable image [grey levels]
constexpr double kLeastAgreeing = 0.3;  // share of still points that must fit the camera's motion
constexpr int kFewPoints = 12;          // judged; with fewer nothing is said of the camera
constexpr double kLongestGap = 3.0;     // of the window: after it everything is begun anew
constexpr double kFastestBody = 8.0;    // of a person's size [m/s]
constexpr double kPointsOfSureObject = 6.0;
constexpr double kStartUp =
    0.35;  // until then slight errors of pose and stereo pass for motion [s]
constexpr double kSamePlace = 0.8;           // between an object and where it is expected [m]
constexpr double kSamePlacePerMetre = 0.02;  // growth with depth [m/m]

bool usable(const cv::Mat& image) {
  cv::Scalar mean, deviation;
  cv::meanStdDev(image, mean, deviation);
  return deviation[0] > kLeastContrast;
}

DisparityImage withoutOffset(const DisparityImage& disparity, double offset) {
  DisparityImage result{disparity.values.clone(), disparity.reduce};
  cv::subtract(disparity.values, offset, result.values, disparity.values > 0.0F);
  cv::max(result.values, 0.0F, result.values);
  return result;
}

double sigmaAlong(const Eigen::Vector3d& vector, const Eigen::Matrix3d& covariance) {
  const Eigen::Vector3d direction = vector.normalized();
  return std::sqrt(direction.dot(covariance * direction));
}

FollowerParams followerOf(const StereoMotionParams& params) {
  return {params.max_points, params.spacing_px,     std::max(params.window_s, params.body_window_s),
          params.range_m,    params.least_height_m, params.most_height_m};
}

}  // namespace

class StereoMotion::Implementation {
 public:
  Implementation(std::shared_ptr<const StereoCamera> camera, const StereoMotionParams& params,
                 std::shared_ptr<DisparityMatcher> matcher)
      : camera_(std::move(camera)),
        params_(params),
        matcher_(std::move(matcher)),
        path_(*camera_, std::hypot(params.sigma_px, 0.3)),
        follower_(*camera_, followerOf(params)),
        blobs_(*camera_, params.window_s) {}

  /// @return  why there is nothing to say of this frame; null if there is
  const char* look(const StereoFrame& frame, const std::optional<Pose>& T_map_robot) {
    objects_.clear();
    cells_.clear();
    if (!usable(frame.left) || !usable(frame.right)) return "unusable_image";
    disparity_ = withoutOffset(matcher_->of(frame), offset_.value());
    ground_ = findGround(disparity_, *camera_, ground_);
    if (!T_map_robot) {
      startAnew();
      return "no_pose";
    }
    if (!path_.empty() &&
        frame.time - path_.timeOf(path_.newest()) > kLongestGap * params_.window_s) {
      startAnew();
    }
    const int number = path_.advance(frame.time, *T_map_robot * camera_->T_robot_cam);
    path_.forgetBefore(firstWithin(std::max(params_.window_s, params_.body_window_s), frame.time));
    follower_.setDisparityOffset(offset_.value());
    follower_.follow(frame, disparity_, path_);
    const char* unsure = judge() ? nullptr : "camera_motion_unsure";
    if (ground_) {
      blobs_.follow(uprightBlobs(disparity_, *camera_, *ground_, params_.blob_range_m), path_, up_);
    }
    if (unsure == nullptr && frame.time - path_.timeOf(path_.oldest()) > kStartUp) {
      identities_.beginFrame(frame.time);
      auto finds = findClusters();
      addBodies(finds);
      for (auto& find : finds) report(find);
    }
    follower_.replenish(frame, disparity_, ground_, number);
    return unsure;
  }

  std::size_t takeImplausible() { return std::exchange(implausible_, 0); }

  [[nodiscard]] MovingRegions regions(Time at) const {
    const double ahead = objects_.empty() ? 0.0 : at - path_.timeOf(path_.newest());
    if (objects_.empty() || ahead > params_.window_s) return {};
    return regionsAhead(objects_, cells_, disparity_.reduce, path_, *camera_, ahead);
  }

  std::vector<MovingObject> objects_;
  DisparityImage disparity_;
  std::optional<GroundPlane> ground_;

 private:
  void startAnew() {
    path_ = CameraPath(*camera_, std::hypot(params_.sigma_px, 0.3));
    follower_.clear();
    blobs_.clear();
    identities_.clear();
  }

  [[nodiscard]] int firstWithin(double window_s, Time now) const {
    int first = path_.oldest();
    while (first < path_.newest() && path_.timeOf(first) < now - window_s - 1e-6) ++first;
    return first;
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
    const int first = firstWithin(params_.window_s, path_.timeOf(path_.newest()));
    for (auto& point : points) {
      point.motion = fitMotion(since(first, point.sightings), path_, *camera_, noise,
                               params_.most_speed / 2.0);
    }
    noise_scale_.update(points);
    up_ = path_.T_cam_world(path_.newest()).linear().transpose() *
          (ground_ ? ground_->up : mountedUp(*camera_));
    dropMismatches();
    offset_.update(points, verdicts_);
    const auto moving = std::count(verdicts_.begin(), verdicts_.end(), PointVerdict::kMoving);
    const auto judged =
        moving + std::count(verdicts_.begin(), verdicts_.end(), PointVerdict::kStill);
    const bool flooded =
        judged >= kFewPoints &&
        static_cast<double>(moving) > params_.most_moving * static_cast<double>(judged);
    const bool astray = static_cast<int>(still.size()) >= kFewPoints && agreeing < kLeastAgreeing;
    return !flooded && !astray;
  }

  [[nodiscard]] VerdictParams verdictParams() const {
    VerdictParams params;
    params.significance = params_.significance;
    params.least_speed = params_.least_speed;
    params.most_speed = params_.most_speed;
    return params;
  }

  void dropMismatches() {
    verdicts_.clear();
    std::vector<PointTrack> kept;
    for (auto& point : follower_.points()) {
      const PointVerdict verdict = verdictOn(point, up_, verdictParams());
      if (verdict == PointVerdict::kMismatch) continue;
      if (verdict == PointVerdict::kStill) point.object = -1;
      verdicts_.push_back(verdict);
      kept.push_back(std::move(point));
    }
    follower_.points() = std::move(kept);
  }

  /// Something that moves, as found in this frame.
  struct Find {
    ObjectExtent extent;
    MeasuredVelocity velocity;  ///< in the world of the path
    int first_frame = 0;        ///< the velocity was measured since then
    int points = 0;
    std::vector<std::size_t> members;  ///< points that move with it
    std::vector<BlobTrack*> bodies;    ///< that are it
  };

  /// Objects of points that move alike.
  std::vector<Find> findClusters() {
    ClusterParams params;
    params.reach_m = params_.reach_m;
    params.least_points = params_.least_points;
    const Pose& T_cam_world = path_.T_cam_world(path_.newest());
    std::vector<Find> finds;
    for (const auto& cluster : clusterMotion(follower_.points(), verdicts_, path_, up_, params)) {
      const double sigma = sigmaAlong(cluster.velocity, cluster.velocity_covariance);
      if (cluster.velocity.norm() < params_.least_speed + 2.0 * sigma) continue;
      std::vector<Eigen::Vector3d> seeds;
      for (const std::size_t i : cluster.members) {
        seeds.push_back(T_cam_world * follower_.points()[i].motion->point);
      }
      const GroundPlane floor = ground_.value_or(floorBelow(seeds, *camera_));
      auto extent = plausibleExtent(growObject(seeds, disparity_, *camera_, floor),
                                    cluster.velocity, floor, params_.moving_share);
      if (!extent) {
        ++implausible_;
        continue;
      }
      finds.push_back({std::move(*extent),
                       {cluster.velocity, cluster.velocity_covariance},
                       firstWithin(params_.window_s, path_.timeOf(path_.newest())),
                       static_cast<int>(cluster.members.size()),
                       cluster.members,
                       {}});
    }
    return finds;
  }

  /// Adds things of a person's size that move as a whole to what points told already.
  void addBodies(std::vector<Find>& finds) {
    if (!ground_) return;
    for (auto& blob : blobs_.tracks()) {
      if (blob.last_frame != path_.newest()) continue;
      const auto velocity = velocityOf(blob);
      if (!velocity) continue;
      auto extent = plausibleExtent(blob.blob.cells, velocity->value, *ground_, 0.0);
      if (!extent) {
        ++implausible_;
        continue;
      }
      const auto known = std::find_if(finds.begin(), finds.end(), [&](const Find& find) {
        const Box2d& other = find.extent.box2d;
        return shareInside(extent->box2d, other) > 0.5 || overlap2d(extent->box2d, other) > 0.3;
      });
      if (known != finds.end()) {
        known->bodies.push_back(&blob);
        continue;
      }
      finds.push_back({std::move(*extent),
                       *velocity,
                       path_.oldest(),
                       static_cast<int>(blob.track.sightings.size()),
                       {},
                       {&blob}});
    }
  }

  /// Of a body that moves; nullopt if it may as well stand.
  [[nodiscard]] std::optional<MeasuredVelocity> velocityOf(const BlobTrack& blob) const {
    BodyParams params;
    params.noise_scale = noise_scale_.value();
    const auto body = bodyMotion(blob.blob, BlobFollower::outlineMotion(blob), follower_.points(),
                                 disparity_, path_, *camera_, up_, params);
    if (body) {
      const double sigma = sigmaAlong(body->velocity, body->covariance);
      const double speed = body->velocity.norm();
      const bool moves = body->evidence > params_.body_significance &&
                         speed > params_.least_speed + sigma && speed < kFastestBody;
      if (!moves) return std::nullopt;
      return MeasuredVelocity{body->velocity, body->covariance};
    }
    if (!blobs_.moves(blob, up_, verdictParams())) return std::nullopt;
    const PointMotion& outline = *blob.track.motion;
    return MeasuredVelocity{overGround(outline.velocity, up_), outline.velocity_covariance};
  }

  /// The box around an object's cells, if enough of the points inside it move too.
  [[nodiscard]] std::optional<ObjectExtent> plausibleExtent(const std::vector<ObjectCell>& cells,
                                                            const Eigen::Vector3d& velocity,
                                                            const GroundPlane& floor,
                                                            double least_share) const {
    auto extent = extentOf(cells, path_.T_cam_world(path_.newest()).linear() * velocity, disparity_,
                           *camera_, floor);
    if (!extent) return std::nullopt;
    const auto [nearest, farthest] = std::minmax_element(
        cells.begin(), cells.end(), [](auto& a, auto& b) { return a.point.z() < b.point.z(); });
    const double share = movingShare(follower_.points(), verdicts_, path_, extent->box2d,
                                     nearest->point.z(), farthest->point.z());
    if (share < least_share) return std::nullopt;
    return extent;
  }

  /// Ids that the parts of a find had before, the most frequent first.
  [[nodiscard]] std::vector<std::int64_t> formerIds(const Find& find) const {
    std::map<std::int64_t, int> votes;
    for (const std::size_t i : find.members) ++votes[follower_.points()[i].object];
    for (const auto* body : find.bodies) ++votes[body->track.object];
    votes.erase(-1);
    std::vector<std::int64_t> ids;
    for (const auto& [id, count] : votes) ids.push_back(id);
    std::stable_sort(ids.begin(), ids.end(), [&](auto a, auto b) { return votes[a] > votes[b]; });
    return ids;
  }

  void report(Find& find) {
    const Pose& T_cam_world = path_.T_cam_world(path_.newest());
    const Eigen::Vector3d& centre = find.extent.box.centre;
    const ObjectIdentity& identity = identities_.identify(
        {formerIds(find), T_cam_world.inverse() * centre, find.velocity.value,
         kSamePlace + kSamePlacePerMetre * centre.z(), find.extent.object_class});
    for (const std::size_t i : find.members) follower_.points()[i].object = identity.id;
    for (auto* body : find.bodies) body->track.object = identity.id;
    if (identity.sightings < params_.confirm_frames) return;
    MovingObject object;
    object.id = identity.id;
    object.velocity = path_.R_map_world() * find.velocity.value;
    object.points = find.points;
    Detection& detection = object.detection;
    if (params_.guess_class) detection.object_class = identity.objectClass();
    detection.score = 1.0 - std::exp(-find.points / kPointsOfSureObject);
    detection.detector_id = identity.id;
    detection.box2d = find.extent.box2d;
    detection.box3d = find.extent.box;
    detection.centre_covariance = find.extent.centre_covariance;
    detection.velocity = rotated(find.velocity, T_cam_world.linear());
    // All those frames tell of it, and each frame's report does so again.
    detection.velocity->covariance *= path_.newest() - find.first_frame + 1;
    cells_.push_back(std::move(find.extent.cells));
    objects_.push_back(std::move(object));
  }

  std::shared_ptr<const StereoCamera> camera_;
  StereoMotionParams params_;
  std::shared_ptr<DisparityMatcher> matcher_;
  CameraPath path_;
  PointFollower follower_;
  BlobFollower blobs_;
  DisparityOffset offset_;
  NoiseScale noise_scale_;
  std::vector<PointVerdict> verdicts_;             ///< one for each followed point
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();  ///< of the ground, world of the path
  ObjectIdentities identities_;
  std::vector<std::vector<cv::Point>> cells_;  ///< of each object
  std::size_t implausible_ = 0;
};

StereoMotion::StereoMotion(std::shared_ptr<const StereoCamera> camera,
                           const StereoMotionParams& params,
                           std::shared_ptr<DisparityMatcher> matcher)
    : implementation_(
          std::make_unique<Implementation>(std::move(camera), params, std::move(matcher))) {}

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
const std::optional<GroundPlane>& StereoMotion::ground() const { return implementation_->ground_; }

}  // namespace headway::detect
