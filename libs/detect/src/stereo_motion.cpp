#include <headway/core/box_overlap.h>
#include <headway/detect/stereo_motion.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>
#include <utility>

#include "blob_follower.h"
#include "disparity_offset.h"
#include "motion_clusters.h"
#include "object_extent.h"
#include "point_follower.h"

namespace headway::detect {
namespace {

constexpr double kLeastContrast = 4.0;  // standard deviation of a usable image [grey levels]
constexpr double kLeastAgreeing = 0.3;  // share of still points that must fit the camera's motion
constexpr int kFewPoints = 12;          // judged; with fewer nothing is said of the camera
constexpr double kLongestGap = 3.0;     // of the window: after it everything is begun anew
constexpr double kShareOfBlob = 0.3;    // moving points in it: many sit on its outline, half behind
constexpr double kPointsOfSureObject = 6.0;

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

FollowerParams followerOf(const StereoMotionParams& params) {
  return {params.max_points, params.spacing_px,     params.window_s,
          params.range_m,    params.least_height_m, params.most_height_m};
}

}  // namespace

void StereoMotionParams::describe(Params::Section section) {
  section.add("max_points", max_points, 100, 10000, "", "Points followed at a time");
  section.add("spacing_px", spacing_px, 4, 64, "px", "Between points");
  section.add("window_s", window_s, 0.1, 3.0, "s", "How far back a point's sightings count");
  section.add("range_m", range_m, 2.0, 200.0, "m", "Farther points are not followed");
  section.add("least_height_m", least_height_m, 0.0, 5.0, "m",
              "Above ground, of points on objects");
  section.add("most_height_m", most_height_m, 0.5, 20.0, "m", "Above ground, of points on objects");
  section.add("sigma_px", sigma_px, 0.05, 5.0, "px", "Error of a point's place in an image");
  section.add("sigma_disparity_px", sigma_disparity_px, 0.05, 5.0, "px",
              "Error of a point's disparity");
  section.add("significance", significance, 5.0, 1000.0, "-",
              "Of a point's motion against standing still, chi-square of 3 degrees of freedom");
  section.add("least_speed", least_speed, 0.05, 20.0, "m/s", "Slower objects stand still");
  section.add("most_speed", most_speed, 1.0, 200.0, "m/s", "Nothing is faster");
  section.add("least_points", least_points, 2, 50, "", "Points that make an object");
  section.add("confirm_frames", confirm_frames, 1, 10, "frames",
              "In which an object must have been found before it is reported");
  section.add("reach_m", reach_m, 0.1, 10.0, "m", "Between points of one object, over the ground");
  section.add("moving_share", moving_share, 0.0, 1.0, "-",
              "Of the points inside an object's outline that must move");
  section.add("blob_range_m", blob_range_m, 2.0, 100.0, "m",
              "Farther things of a person's size are not followed as a whole");
  section.add("most_moving", most_moving, 0.1, 1.0, "-",
              "If more of all points seem to move, the camera's motion is taken for wrong");
  section.add("guess_class", guess_class,
              "Guess classes from size and speed; else every object is Unknown");
}

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
    taken_.clear();
    outlines_.clear();
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
    path_.forgetBefore(firstInWindow(frame.time));
    follower_.setDisparityOffset(offset_.value());
    follower_.follow(frame, disparity_, path_);
    const char* unsure = judge() ? nullptr : "camera_motion_unsure";
    if (ground_) {
      blobs_.follow(uprightBlobs(disparity_, *camera_, *ground_, params_.blob_range_m), path_);
    }
    if (unsure == nullptr) {
      findClusters();
      findBlobs();
    }
    follower_.replenish(frame, disparity_, ground_, number);
    return unsure;
  }

  std::size_t takeImplausible() { return std::exchange(implausible_, 0); }

  [[nodiscard]] MovingRegions regions(Time at) const {
    MovingRegions regions;
    const double ahead = objects_.empty() ? 0.0 : at - path_.timeOf(path_.newest());
    if (objects_.empty() || ahead > params_.window_s) return regions;
    regions.mask = cv::Mat(camera_->height, camera_->width, CV_8U, cv::Scalar(0));
    const int side = disparity_.reduce;
    const cv::Rect image({0, 0}, regions.mask.size());
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      const cv::Point2d shift = shiftOf(objects_[i], ahead);
      const Box2d& box = *objects_[i].detection.box2d;
      regions.boxes.push_back(
          {box.left + shift.x, box.top + shift.y, box.right + shift.x, box.bottom + shift.y});
      for (const auto& cell : cells_[i]) {
        // One cell more each way: the outline's corners are the worst landmarks.
        const cv::Rect square((cell.x - 1) * side + cvRound(shift.x),
                              (cell.y - 1) * side + cvRound(shift.y), 3 * side, 3 * side);
        regions.mask(square & image).setTo(255);
      }
    }
    return regions;
  }

  std::vector<MovingObject> objects_;
  DisparityImage disparity_;
  std::optional<GroundPlane> ground_;

 private:
  void startAnew() {
    path_ = CameraPath(*camera_, std::hypot(params_.sigma_px, 0.3));
    follower_.clear();
    blobs_.clear();
  }

  /// How far an object's middle moves in the image if it and the camera go on as they did [px].
  [[nodiscard]] cv::Point2d shiftOf(const MovingObject& object, double ahead) const {
    const Pose& T_cam_world = path_.T_cam_world(path_.newest());
    const Eigen::Vector3d centre = object.detection.box3d->centre;
    const Eigen::Vector3d velocity =
        T_cam_world.linear() * path_.R_map_world().transpose() * object.velocity;
    const Eigen::Vector3d later = path_.expectedMotion(ahead) * (centre + ahead * velocity);
    const auto from = project(centre, *camera_);
    const auto to = project(later, *camera_);
    if (!from || !to) return {};
    return {to->x() - from->x(), to->y() - from->y()};
  }

  [[nodiscard]] int firstInWindow(Time now) const {
    int first = path_.oldest();
    while (first < path_.newest() && path_.timeOf(first) < now - params_.window_s - 1e-6) ++first;
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
    for (auto& point : points) {
      point.motion = fitMotion(point.sightings, path_, *camera_, noise, params_.most_speed / 2.0);
    }
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

  /// Objects of points that move alike.
  void findClusters() {
    ClusterParams params;
    params.reach_m = params_.reach_m;
    params.least_points = params_.least_points;
    const Pose& T_cam_world = path_.T_cam_world(path_.newest());
    for (const auto& cluster : clusterMotion(follower_.points(), verdicts_, path_, up_, params)) {
      if (cluster.velocity.norm() < params_.least_speed + 2.0 * cluster.speed_sigma) continue;
      std::vector<Eigen::Vector3d> seeds;
      for (const std::size_t i : cluster.members) {
        seeds.push_back(T_cam_world * follower_.points()[i].motion->point);
      }
      const GroundPlane floor = ground_.value_or(floorBelow(seeds, *camera_));
      const auto extent = plausibleExtent(growObject(seeds, disparity_, *camera_, floor),
                                          cluster.velocity, floor, params_.moving_share);
      if (!extent) {
        ++implausible_;
        continue;
      }
      report(*extent, identify(cluster), cluster.velocity, cluster.speed_sigma,
             static_cast<int>(cluster.members.size()));
    }
  }

  /// Things of a person's size that move as a whole, where no points told so already.
  void findBlobs() {
    for (auto& blob : blobs_.tracks()) {
      if (blob.track.sightings.back().frame != path_.newest()) continue;
      if (!ground_ || !blobs_.moves(blob, up_, verdictParams())) continue;
      const PointMotion& motion = *blob.track.motion;
      const Eigen::Vector3d velocity = motion.velocity - up_ * up_.dot(motion.velocity);
      const auto extent = plausibleExtent(blob.blob.cells, velocity, *ground_, kShareOfBlob);
      if (!extent) {
        ++implausible_;
        continue;
      }
      const bool known = std::any_of(outlines_.begin(), outlines_.end(), [&](const Box2d& other) {
        return shareInside(extent->box2d, other) > 0.5 || overlap2d(extent->box2d, other) > 0.3;
      });
      if (known) continue;
      if (blob.track.object < 0) {
        blob.track.object = next_object_++;
        ages_[blob.track.object] = params_.confirm_frames - 1;  // followed for long enough already
      }
      const Eigen::Vector3d direction = velocity.normalized();
      report(*extent, blob.track.object, velocity,
             std::sqrt(direction.dot(motion.velocity_covariance * direction)),
             static_cast<int>(blob.track.sightings.size()));
    }
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

  void report(const ObjectExtent& extent, std::int64_t id, const Eigen::Vector3d& velocity,
              double speed_sigma, int points) {
    outlines_.push_back(extent.box2d);
    taken_.push_back(id);
    if (++ages_[id] < params_.confirm_frames) return;
    MovingObject object;
    object.id = id;
    object.velocity = path_.R_map_world() * velocity;
    object.speed_sigma = speed_sigma;
    object.points = points;
    Detection& detection = object.detection;
    if (params_.guess_class) detection.object_class = extent.object_class;
    detection.score = 1.0 - std::exp(-points / kPointsOfSureObject);
    detection.detector_id = id;
    detection.box2d = extent.box2d;
    detection.box3d = extent.box;
    detection.centre_covariance = extent.centre_covariance;
    cells_.push_back(extent.cells);
    objects_.push_back(std::move(object));
  }

  /// The id that most of the members had before, unless another object took it in this frame.
  std::int64_t identify(const MotionCluster& cluster) {
    std::map<std::int64_t, int> votes;
    for (const std::size_t i : cluster.members) {
      const std::int64_t id = follower_.points()[i].object;
      const bool taken = std::find(taken_.begin(), taken_.end(), id) != taken_.end();
      if (id >= 0 && !taken) ++votes[id];
    }
    const auto winner = std::max_element(votes.begin(), votes.end(),
                                         [](auto& a, auto& b) { return a.second < b.second; });
    const std::int64_t id = winner != votes.end() ? winner->first : next_object_++;
    for (const std::size_t i : cluster.members) follower_.points()[i].object = id;
    return id;
  }

  std::shared_ptr<const StereoCamera> camera_;
  StereoMotionParams params_;
  std::shared_ptr<DisparityMatcher> matcher_;
  CameraPath path_;
  PointFollower follower_;
  BlobFollower blobs_;
  DisparityOffset offset_;
  std::vector<PointVerdict> verdicts_;             ///< one for each followed point
  Eigen::Vector3d up_ = Eigen::Vector3d::UnitZ();  ///< of the ground, world of the path
  std::vector<std::int64_t> taken_;                ///< ids given in this frame
  std::vector<Box2d> outlines_;                    ///< of this frame's objects, unconfirmed too
  std::map<std::int64_t, int> ages_;               ///< frames in which an object was found
  std::vector<std::vector<cv::Point>> cells_;      ///< of each object
  std::int64_t next_object_ = 0;
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
