// SPDX-License-Identifier: BSD-3-Clause
// What a driven robot knows of its world: by its images, or by the truth.
#include "eyes.h"

#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/live_source.h>
#include <headway/io/mrpt_time.h>
#include <headway/pipeline/perception.h>
#include <headway/run/session.h>
#include <headway/sim/recording.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::app {
namespace {

using Eigen::Vector2d;

/// Whether a pose leads to a goal: three standard deviations are no more than the radius that
/// counts as reached, and than the bearing of a target that a forward arc reaches.
bool isKnown(const PoseCovariance& covariance) {
  constexpr double kSigma_m = 0.3, kSigma_rad = 0.1;
  const PoseCovariance::ConstDiagonalReturnType variance = covariance.diagonal();
  return variance.head<3>().maxCoeff() < kSigma_m * kSigma_m &&
         variance.tail<3>().maxCoeff() < kSigma_rad * kSigma_rad;
}

/// headway's perception of the images that the robot's rig takes, and of its wheels.
class ImagesEye : public Eye {
 public:
  ImagesEye(const RobotParams& robot, const objects::ObjectsParams& objects, bool local_layer) {
    params_.grid.local = local_layer;
    params_.detection.detector = "stereo_motion+shape";
    params_.robot = map::RobotFootprint{robot.length_m, robot.width_m};
    params_.objects = objects;
  }

  [[nodiscard]] Knowledge perceive(sim::DrivenWorld& world) override {
    const sim::SimFrame frame = world.look();
    const auto observation =
        sim::observationOf(frame, world.recordedCamera(), world.camera().depth_reach_m);
    if (!live_) {
      io::LiveSourceOptions options;
      options.observations.sensor_label = observation->sensorLabel;  // else a second one is awaited
      live_.emplace(options);
      source_.emplace(*live_);
    }
    if (frame.odometry) {
      const auto wheels = mrpt::obs::CObservationOdometry::Create();
      wheels->timestamp = io::mrptTime(frame.odometry->time);
      wheels->sensorLabel = "odometry";
      wheels->odometry = {frame.odometry->x, frame.odometry->y, frame.odometry->yaw};
      live_->push(wheels);
    }
    live_->push(observation);
    if (!session_) {
      perception_.emplace(source_->camera(), params_);
      session_.emplace(*source_, *perception_);
    }
    const auto result = session_->next();
    if (!result) throw InputError("a rendered frame was not taken");
    Knowledge knowledge;
    knowledge.map = perception_->map();
    const auto& camera = result->update.camera;
    const Eigen::Vector3d place = camera.T_map_robot.translation();
    knowledge.expected = mrpt::math::TPose2D(place.x(), place.y(), yawOf(camera.T_map_robot));
    // Who is lost goes on by wheels for as long as those know where it has come since.
    const bool goes_on = camera.status == slam::TrackingStatus::kLost && frame.odometry;
    if (isTracked(camera.status)) when_tracked_ = camera.covariance;
    if (isTracked(camera.status) || (goes_on && isKnown(camera.covariance - when_tracked_))) {
      knowledge.pose = knowledge.expected;
    }
    knowledge.image = frame.left;
    return knowledge;
  }

 private:
  pipeline::PerceptionParams params_;
  PoseCovariance when_tracked_ = PoseCovariance::Zero();  ///< the last time
  std::optional<io::LiveSource> live_;
  std::optional<run::SensorFrames> source_;
  std::optional<pipeline::Perception> perception_;
  std::optional<run::Session> session_;
};

/// A perfect eye: true pose, a grid of everything that stands, and the true velocities of all
/// who move within reach and are not behind it.
class TruthEye : public Eye {
 public:
  [[nodiscard]] Knowledge perceive(sim::DrivenWorld& world) override {
    if (!grid_) grid_ = gridOf(world.things());
    const sim::DrivenRobot robot = world.robot();
    std::vector<Track> tracks;
    for (const sim::Mover& mover : world.movers()) {
      if (sees(robot.position, mover.shape.centre)) {
        tracks.push_back(trackOf(mover, world.now()));
      }
    }
    Knowledge knowledge;
    knowledge.map.update(grid_);
    knowledge.map.update(world.now(), std::move(tracks));
    knowledge.expected = mrpt::math::TPose2D(robot.position.x(), robot.position.y(), robot.yaw);
    knowledge.pose = knowledge.expected;
    return knowledge;
  }

 private:
  static constexpr double kReach_m = 12.0;  // as far as the planner takes objects into account
  static constexpr double kCell_m = 0.1;

  [[nodiscard]] bool sees(const Vector2d& from, const Vector2d& to) const;
  static mrpt::maps::COccupancyGridMap2D::Ptr gridOf(const std::vector<sim::Footprint>& things);
  static Track trackOf(const sim::Mover& mover, Time now);

  mrpt::maps::COccupancyGridMap2D::Ptr grid_;
};

mrpt::maps::COccupancyGridMap2D::Ptr TruthEye::gridOf(const std::vector<sim::Footprint>& things) {
  Eigen::AlignedBox2d bounds(Vector2d(-1.0, -1.0), Vector2d(1.0, 1.0));
  std::vector<std::vector<Vector2d>> outlines;
  for (const sim::Footprint& thing : things) {
    auto& outline = outlines.emplace_back();
    for (const auto& [x, y] : {std::pair{0.5, 0.5}, {-0.5, 0.5}, {-0.5, -0.5}, {0.5, -0.5}}) {
      const Vector2d corner = Vector2d(x, y).cwiseProduct(thing.size);
      outline.push_back(thing.centre + Eigen::Rotation2Dd(thing.yaw) * corner);
      bounds.extend(outline.back());
    }
  }
  auto grid = mrpt::maps::COccupancyGridMap2D::Create(
      static_cast<float>(bounds.min().x()), static_cast<float>(bounds.max().x()),
      static_cast<float>(bounds.min().y()), static_cast<float>(bounds.max().y()),
      static_cast<float>(kCell_m));
  cv::Mat occupied =
      cv::Mat::zeros(static_cast<int>(grid->getSizeY()), static_cast<int>(grid->getSizeX()), CV_8U);
  constexpr int kShift = 4;  // binary digits behind the point
  for (const auto& outline : outlines) {
    std::vector<cv::Point> corners;
    for (const Vector2d& corner : outline) {
      const double u = (corner.x() - grid->getXMin()) / kCell_m - 0.5;
      const double v = (corner.y() - grid->getYMin()) / kCell_m - 0.5;
      corners.emplace_back(cvRound(u * (1 << kShift)), cvRound(v * (1 << kShift)));
    }
    cv::fillConvexPoly(occupied, corners, cv::Scalar(255), cv::LINE_8, kShift);
  }
  for (int v = 0; v < occupied.rows; ++v) {
    for (int u = 0; u < occupied.cols; ++u) {
      grid->setCell(u, v, occupied.at<uchar>(v, u) != 0 ? 0.02F : 0.98F);
    }
  }
  return grid;
}

bool TruthEye::sees(const Vector2d& from, const Vector2d& to) const {
  constexpr double kBody_m = 0.4;  // of who touches a wall, some is seen before it
  const double distance = (to - from).norm();
  if (distance > kReach_m) return false;
  for (double d = 0.0; d < distance - kBody_m; d += kCell_m) {
    const Vector2d at = from + d / distance * (to - from);
    const auto x = static_cast<float>(at.x()), y = static_cast<float>(at.y());
    if (grid_->getPos(x, y) < 0.5F) return false;  // outside: 0.5
  }
  return true;
}

Track TruthEye::trackOf(const sim::Mover& mover, Time now) {
  constexpr double kMoving_mps = 0.1;  // who is slower shifts from foot to foot
  constexpr double kSigma_m = 0.05, kSigmaGrowth_mps = 0.15;  // people step aside and slow down
  constexpr int kPoints = 30;
  Track track;
  track.id.value = mover.id;
  track.object_class = mover.object_class;
  track.status = TrackStatus::kConfirmed;
  track.motion_state =
      mover.velocity.norm() > kMoving_mps ? MotionState::kMoving : MotionState::kStatic;
  track.score = 1.0;
  track.position << mover.shape.centre, 0.5 * mover.height_m;
  track.velocity << mover.velocity, 0.0;
  track.yaw = mover.shape.yaw;
  track.size << mover.shape.size + Vector2d::Constant(2.0 * mover.radius_m), mover.height_m;
  track.position_covariance = kSigma_m * kSigma_m * Eigen::Matrix3d::Identity();
  track.velocity_covariance = kSigma_m * kSigma_m * Eigen::Matrix2d::Identity();
  track.first_seen = track.last_seen = now;
  PredictedPath path;
  for (int i = 1; i <= kPoints; ++i) {
    const double horizon_s = 0.1 * i, sigma = kSigma_m + kSigmaGrowth_mps * horizon_s;
    path.points.push_back({horizon_s, track.position + horizon_s * track.velocity,
                           sigma * sigma * Eigen::Matrix2d::Identity()});
  }
  track.predictions.push_back(std::move(path));
  return track;
}

}  // namespace

const std::vector<std::pair<std::string, Sense>>& senses() {
  static const std::vector<std::pair<std::string, Sense>> kSenses = {
      {"images", Sense::kImages}, {"truth", Sense::kTruth}, {"detections", Sense::kDetections}};
  return kSenses;
}

std::unique_ptr<Eye> makeEye(Sense sense, const RobotParams& robot,
                             const objects::ObjectsParams& objects, bool local_layer) {
  if (sense == Sense::kTruth) return std::make_unique<TruthEye>();
  return std::make_unique<ImagesEye>(robot, objects, local_layer);
}

}  // namespace headway::app
