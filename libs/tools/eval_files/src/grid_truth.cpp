// SPDX-License-Identifier: BSD-3-Clause
#include "grid_truth.h"

#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <string>
#include <unordered_map>
#include <utility>

#include "truth_images.h"

namespace headway::eval_files {
namespace {

namespace fs = std::filesystem;

constexpr double kReach_m = 40.0;         ///< beyond this range a pixel covers more than a cell
constexpr double kGround_m = 0.15;        ///< maximum height of ground and kerbs
constexpr double kHeightMargin_m = 0.01;  ///< surfaces this close to the asked height are undecided
constexpr double kAheadFrom_m = 0.5;
constexpr double kAheadTo_m = 3.0;
constexpr int kMinPixels = 2;       ///< over all frames; rejects mixed pixels at depth edges
constexpr int kVisiblePixels = 49;  ///< of an obstacle in one frame: a quarter of a matched block
constexpr double kSweptMargin_m = 0.2;

/// Number of pixels on the ground and on obstacles in each cell.
struct PixelCounts {
  explicit PixelCounts(std::size_t cells)
      : ground(cells, 0), obstacle(cells, 0), in_reach(cells, 0), ahead(cells, 0), drop(cells, 0) {}
  std::vector<int> ground;
  std::vector<int> obstacle;
  std::vector<int> in_reach;  ///< of the obstacle, most in one frame
  std::vector<int> ahead;     ///< of the obstacle, most in one frame
  std::vector<int> drop;
};

void countPixels(const cv::Mat& depth, const cv::Mat& moving, const StereoCamera& camera,
                 const Pose& T_map_robot, const eval::GridCells& grid,
                 const ObstacleHeights& heights, const ObstacleReach& reach, PixelCounts& counts) {
  const double ground = std::min(kGround_m, heights.min_m - kHeightMargin_m);
  std::unordered_map<std::size_t, int> in_reach;
  std::unordered_map<std::size_t, int> ahead;
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const auto z = static_cast<double>(depth.at<float>(v, u));
      if (z <= 0.0 || z > kReach_m || moving.at<std::uint8_t>(v, u) != 0) continue;
      const Eigen::Vector3d in_robot =
          camera.T_robot_cam * (z * ray(Eigen::Vector2d(u, v), camera));
      const Eigen::Vector3d in_map = T_map_robot * in_robot;
      const auto cell = grid.at(in_map.head<2>());
      if (!cell) continue;
      // Simulated ground is level, while the robot pitches and rolls: heights are taken in the map.
      const double height = in_map.z() - T_map_robot.translation().z();
      if (height <= -heights.min_m) ++counts.drop[*cell];
      if (height < ground && height > -heights.min_m) ++counts.ground[*cell];
      if (height < heights.min_m + kHeightMargin_m || height > heights.max_m) continue;
      ++counts.obstacle[*cell];
      const double hidden = camera.isDepthCamera() ? 0.0 : camera.fx * camera.baseline_m / z;
      if (u < hidden) continue;  // outside of the right image
      if (z >= reach.from_m && z <= reach.to_m) ++in_reach[*cell];
      if (z >= kAheadFrom_m && z <= kAheadTo_m) ++ahead[*cell];
    }
  }
  for (const auto& [cell, n] : in_reach) counts.in_reach[cell] = std::max(counts.in_reach[cell], n);
  for (const auto& [cell, n] : ahead) counts.ahead[cell] = std::max(counts.ahead[cell], n);
}

/// Marks the cells covered by the box of a moving object.
void markSwept(const Track& object, const eval::GridCells& grid, std::vector<std::uint8_t>& swept) {
  const double along = 0.5 * object.size.x() + kSweptMargin_m;
  const double across = 0.5 * object.size.y() + kSweptMargin_m;
  const Eigen::Vector2d front(std::cos(object.yaw), std::sin(object.yaw));
  const Eigen::Vector2d left(-front.y(), front.x());
  const double step = 0.5 * grid.resolution_m;
  for (double a = -along; a <= along; a += step) {
    for (double b = -across; b <= across; b += step) {
      const auto cell = grid.at(object.position.head<2>() + a * front + b * left);
      if (cell) swept[*cell] = 1;
    }
  }
}

/// Outlines of drops.csv, by number; empty if there is no such file.
std::map<int, std::vector<Eigen::Vector2d>> readDrops(const fs::path& path) {
  std::map<int, std::vector<Eigen::Vector2d>> outlines;
  std::ifstream file(path);
  std::string row;
  std::getline(file, row);  // header
  for (int line = 2; std::getline(file, row); ++line) {
    int drop = 0;
    double x = 0.0, y = 0.0;
    if (std::sscanf(row.c_str(), "%d,%lf,%lf", &drop, &x, &y) != 3) {
      throw InputError(path.string() + ":" + std::to_string(line) + ": is not drop,x,y,depth_m");
    }
    outlines[drop].emplace_back(x, y);
  }
  return outlines;
}

/// Whether a point lies to the left of all edges of a counterclockwise outline.
bool isInside(const Eigen::Vector2d& point, const std::vector<Eigen::Vector2d>& outline) {
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d edge = outline[(i + 1) % outline.size()] - outline[i];
    const Eigen::Vector2d to = point - outline[i];
    if (edge.x() * to.y() - edge.y() * to.x() < 0.0) return false;
  }
  return true;
}

/// Marks the cells that lie in a drop with all four corners.
void markDrops(const fs::path& path, const eval::GridCells& grid,
               std::vector<std::uint8_t>& drops) {
  for (const auto& [number, outline] : readDrops(path)) {
    for (std::size_t i = 0; i < drops.size(); ++i) {
      const auto columns = static_cast<std::size_t>(grid.columns);
      bool whole = true;
      for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        const Eigen::Vector2d corner(static_cast<double>(i % columns) + x,
                                     static_cast<double>(i / columns) + y);
        whole = whole && isInside(grid.origin + grid.resolution_m * corner, outline);
      }
      if (whole) drops[i] = 1;
    }
  }
}

}  // namespace

GridTruth gridTruth(const fs::path& folder, const StereoCamera& camera, const eval::GridCells& grid,
                    const ObstacleHeights& heights, const ObstacleReach& reach) {
  const std::vector<std::uint8_t> none(grid.states.size(), 0);
  GridTruth truth{grid, none, none, none, none};
  const auto poses = io::readTum((folder / "trajectory.tum").string());
  PixelCounts counts(grid.states.size());
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    const cv::Mat moving = readMovingMask(folder, frame, camera);
    countPixels(readTrueDepth(folder, frame, camera), moving, camera, poses[frame].value, grid,
                heights, reach, counts);
  }
  for (std::size_t i = 0; i < grid.states.size(); ++i) {
    truth.cells.states[i] = counts.obstacle[i] >= kMinPixels ? eval::CellState::kOccupied
                            : counts.ground[i] >= kMinPixels ? eval::CellState::kFree
                                                             : eval::CellState::kUnknown;
    truth.in_reach[i] = counts.in_reach[i] >= kVisiblePixels;
    truth.ahead[i] = counts.ahead[i] >= kVisiblePixels;
    // A pit's wall is no obstacle of its own; what reaches above the ground is.
    truth.drops[i] = counts.drop[i] >= kMinPixels && counts.obstacle[i] < kMinPixels;
  }
  markDrops(folder / "drops.csv", grid, truth.drops);
  for (const auto& sample : io::readTrackCsv((folder / "objects.csv").string())) {
    if (isMoving(sample.track)) markSwept(sample.track, grid, truth.swept);
  }
  return truth;
}

}  // namespace headway::eval_files
