#include <headway/map/static_grid.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "sight_lines.h"

namespace headway::map {
namespace {

using PositionById = std::unordered_map<LandmarkId, Eigen::Vector3d>;

constexpr double kMostCells = 25e6;
constexpr double kCameraOnRobotM = 0.3;  ///< the camera is at least so high: the origin is below it
constexpr double kGroundReachM = 12.0;
constexpr double kGroundBinM = 0.1;
constexpr int kGroundBins = 30;  ///< from 0.3 to 3.3 m below the camera
constexpr double kFirstBinM = 0.3;
constexpr int kFewestOnGround = 30;
constexpr double kDrivenM = 5.0;  ///< farther apart, keyframes do not tell the way between

PositionById usedLandmarks(const slam::MapView& still_world, int min_observations) {
  PositionById positions;
  for (const auto& landmark : still_world.landmarks) {
    if (landmark.observations >= min_observations) positions[landmark.id] = landmark.position;
  }
  return positions;
}

/// Calls `use(camera position, landmark position, landmark in the robot frame)` for every landmark
/// that a keyframe sees, the last two only if it is within reach.
template <typename Use>
void forEachSight(const slam::KeyframeView& keyframe, const PositionById& positions,
                  const StereoCamera& camera, double reach, const Use& use) {
  const Eigen::Vector3d eye = keyframe.T_map_robot * camera.T_robot_cam.translation();
  const Pose T_robot_map = keyframe.T_map_robot.inverse();
  for (const auto id : keyframe.landmarks) {
    const auto position = positions.find(id);
    if (position == positions.end()) continue;
    if ((position->second - eye).head<2>().norm() > reach) continue;
    use(eye, position->second, Eigen::Vector3d(T_robot_map * position->second));
  }
}

Eigen::AlignedBox2d boundsOf(const slam::MapView& still_world, const PositionById& positions,
                             const StereoCamera& camera, double reach) {
  Eigen::AlignedBox2d bounds;
  for (const auto& keyframe : still_world.keyframes) {
    bounds.extend(keyframe.T_map_robot.translation().head<2>());
    forEachSight(keyframe, positions, camera, reach,
                 [&](const Eigen::Vector3d&, const Eigen::Vector3d& landmark,
                     const Eigen::Vector3d&) { bounds.extend(landmark.head<2>()); });
  }
  return bounds;
}

double coarseEnough(double resolution, const Eigen::AlignedBox2d& bounds) {
  while (bounds.sizes().x() * bounds.sizes().y() > kMostCells * resolution * resolution) {
    resolution *= 2.0;
  }
  return resolution;
}

/// Where the robot went from one keyframe to the next, nothing stands.
void addDriven(const std::vector<slam::KeyframeView>& keyframes, SightLines& lines) {
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    Eigen::Vector2d from = keyframes[i - 1].T_map_robot.translation().head<2>();
    Eigen::Vector2d to = keyframes[i].T_map_robot.translation().head<2>();
    if ((to - from).norm() > kDrivenM) continue;
    if (std::make_pair(to.x(), to.y()) < std::make_pair(from.x(), from.y())) from.swap(to);
    lines.beginKeyframe();
    lines.free(from, to);
  }
}

}  // namespace

void StaticGridParams::describe(Params::Section section) {
  section.add("grid_resolution", resolution_m, 0.05, 2.0, "m", "Side of a cell of the grid map");
  section.add("grid_reach", reach_m, 2.0, 100.0, "m",
              "Landmarks farther than this from a keyframe do not enter the grid map");
  section.add("grid_lowest_obstacle", lowest_obstacle_m, 0.05, 2.0, "m",
              "What is lower above the ground does not stop the robot");
  section.add("grid_highest_obstacle", highest_obstacle_m, 0.3, 10.0, "m",
              "What is higher above the ground does not stop the robot");
  section.add("grid_min_observations", min_observations, 1, 20, "keyframes",
              "Landmarks seen in fewer keyframes do not enter the grid map");
}

std::optional<double> groundInRobot(const slam::MapView& still_world, const StereoCamera& camera) {
  const double camera_height = camera.T_robot_cam.translation().z();
  if (camera_height >= kCameraOnRobotM) return 0.0;
  const auto positions = usedLandmarks(still_world, 1);
  std::vector<int> bins(kGroundBins, 0);
  for (const auto& keyframe : still_world.keyframes) {
    forEachSight(keyframe, positions, camera, kGroundReachM,
                 [&](const Eigen::Vector3d&, const Eigen::Vector3d&, const Eigen::Vector3d& p) {
                   const double below = camera_height - p.z() - kFirstBinM;
                   const int bin = static_cast<int>(std::floor(below / kGroundBinM));
                   if (bin >= 0 && bin < kGroundBins) ++bins[static_cast<std::size_t>(bin)];
                 });
  }
  const auto most = std::max_element(bins.begin(), bins.end());
  if (*most < kFewestOnGround) return std::nullopt;
  const double below = kFirstBinM + kGroundBinM * (0.5 + static_cast<double>(most - bins.begin()));
  return camera_height - below;
}

mrpt::maps::COccupancyGridMap2D::Ptr buildStaticGrid(const slam::MapView& still_world,
                                                     const StereoCamera& camera,
                                                     const StaticGridParams& params) {
  const auto ground = groundInRobot(still_world, camera);
  if (still_world.keyframes.empty() || !ground) return nullptr;
  const auto positions = usedLandmarks(still_world, params.min_observations);
  const auto bounds = boundsOf(still_world, positions, camera, params.reach_m);
  SightLines lines(bounds, coarseEnough(params.resolution_m, bounds));
  addDriven(still_world.keyframes, lines);
  for (const auto& keyframe : still_world.keyframes) {
    lines.beginKeyframe();
    forEachSight(keyframe, positions, camera, params.reach_m,
                 [&](const Eigen::Vector3d& eye, const Eigen::Vector3d& landmark,
                     const Eigen::Vector3d& in_robot) {
                   const double height = in_robot.z() - *ground;
                   if (height > params.highest_obstacle_m) return;
                   const Eigen::Vector2d from = eye.head<2>(), to = landmark.head<2>();
                   if (height >= params.lowest_obstacle_m) {
                     lines.occupied(from, to);
                     return;
                   }
                   const double eye_height = camera.T_robot_cam.translation().z() - *ground;
                   const double low_share = std::clamp(
                       (params.lowest_obstacle_m - height) / (eye_height - height), 0.0, 1.0);
                   lines.free(to + low_share * (from - to), to);
                 });
  }
  return lines.grid();
}

}  // namespace headway::map
