#include <headway/nav/predictive_obstacles.h>
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CSimplePointsMap.h>

#include <cmath>

namespace headway::nav {
namespace {

using Eigen::Vector2d;

bool isFinite(const mrpt::math::TPose2D& pose) {
  return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.phi);
}

}  // namespace

std::string_view toString(SenseStatus status) {
  switch (status) {
    case SenseStatus::kSafe:
      return "safe";
    case SenseStatus::kInnerFailed:
      return "inner_failed";
    case SenseStatus::kNoPose:
      return "no_pose";
    case SenseStatus::kStaleMap:
      return "stale_map";
  }
  return "unknown";
}

PredictiveObstacles::PredictiveObstacles(mrpt::nav::CRobot2NavInterface& robot, MapSource map,
                                         const PredictiveObstaclesParams& params, Clock clock)
    : robot_(robot),
      map_(std::move(map)),
      clock_(clock ? std::move(clock) : Clock(&mrpt::Clock::nowDouble)),
      params_(params),
      moving_(params) {
  setLoggerName("PredictiveObstacles");
}

bool PredictiveObstacles::senseObstacles(mrpt::maps::CSimplePointsMap& obstacles,
                                         mrpt::system::TTimeStamp& timestamp) {
  report_ = SenseReport();
  if (!robot_.senseObstacles(obstacles, timestamp)) return false;
  report_.status =
      params_.policy == ObstaclePolicy::kStatic ? SenseStatus::kSafe : addPredictions(obstacles);
  if (report_.status != SenseStatus::kSafe) {
    MRPT_LOG_THROTTLE_ERROR_FMT(1.0, "obstacles are unsafe: %s (map is %.2f s old, limit %.2f s)",
                                std::string(toString(report_.status)).c_str(), report_.map_age_s,
                                params_.max_age_s);
  }
  return report_.status == SenseStatus::kSafe;
}

SenseStatus PredictiveObstacles::addPredictions(mrpt::maps::CSimplePointsMap& obstacles) {
  const map::PerceptionMap snapshot = map_();
  const CMovingObjectsMap& layer = snapshot.movingObjects();
  report_.map_age_s = clock_() - layer.time();
  if (!(std::abs(report_.map_age_s) <= params_.max_age_s)) return SenseStatus::kStaleMap;

  mrpt::math::TPose2D pose, odometry;
  mrpt::math::TTwist2D velocity;
  mrpt::system::TTimeStamp timestamp;
  std::string frame_id = params_.map_frame;
  if (!robot_.getCurrentPoseAndSpeeds(pose, velocity, timestamp, odometry, frame_id) ||
      !isFinite(pose) || frame_id != params_.map_frame) {
    return SenseStatus::kNoPose;
  }
  moving_.update(layer.tracks(), {pose.x, pose.y}, std::max(0.0, report_.map_age_s));
  report_.movers = moving_.movers().size();
  removeGone(obstacles, pose);
  insertPredicted(obstacles, pose);
  return SenseStatus::kSafe;
}

void PredictiveObstacles::removeGone(mrpt::maps::CSimplePointsMap& obstacles,
                                     const mrpt::math::TPose2D& pose) {
  const auto& xs = obstacles.getPointsBufferRef_x();
  const auto& ys = obstacles.getPointsBufferRef_y();
  const double c = std::cos(pose.phi);
  const double s = std::sin(pose.phi);
  std::vector<bool> gone(xs.size(), false);
  for (std::size_t i = 0; i < xs.size(); ++i) {
    const double x = xs[i];
    const double y = ys[i];
    gone[i] = moving_.willBeGone({pose.x + c * x - s * y, pose.y + s * x + c * y});
    if (gone[i]) ++report_.points_removed;
  }
  if (report_.points_removed > 0) obstacles.applyDeletionMask(gone);
}

void PredictiveObstacles::insertPredicted(mrpt::maps::CSimplePointsMap& obstacles,
                                          const mrpt::math::TPose2D& pose) {
  const double c = std::cos(pose.phi);
  const double s = std::sin(pose.phi);
  for (const auto& point : moving_.points()) {
    const Vector2d offset = point.place - Vector2d(pose.x, pose.y);
    const auto x = static_cast<float>(c * offset.x() + s * offset.y());
    const auto y = static_cast<float>(c * offset.y() - s * offset.x());
    const double height = point.top - point.bottom;
    const int layers = std::max(1, static_cast<int>(std::ceil(height / params_.layer_spacing_m)));
    for (int i = 0; i < layers; ++i) {
      const double z = point.bottom + height * (i + 0.5) / layers;
      obstacles.insertPointFast(x, y, static_cast<float>(z));
      ++report_.points_added;
    }
  }
  obstacles.mark_as_modified();
}

}  // namespace headway::nav
