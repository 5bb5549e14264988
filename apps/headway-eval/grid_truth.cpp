#include "grid_truth.h"

#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>

namespace headway::app {
namespace {

namespace fs = std::filesystem;

constexpr double kDepthUnit = 256.0;  ///< KITTI's: a value of 256 is one metre
constexpr double kReach_m = 40.0;     ///< farther, a pixel is wider than a cell
constexpr double kGround_m = 0.15;    ///< what is lower is ground, or a kerb
constexpr int kLeastSeen = 2;         ///< pixels in all, against those that straddle an edge
constexpr double kTreadMargin_m = 0.2;

fs::path numbered(const fs::path& folder, std::size_t frame) {
  char name[32];
  std::snprintf(name, sizeof name, "%06zu.png", frame);
  return folder / name;
}

cv::Mat readImage(const fs::path& path, const StereoCamera& camera) {
  cv::Mat image = cv::imread(path.string(), cv::IMREAD_UNCHANGED);
  if (image.empty()) {
    throw InputError(path.string() +
                     ": cannot be read; was the world recorded with --depth --masks?");
  }
  if (image.size() != cv::Size(camera.width, camera.height)) {
    throw InputError(path.string() + ": is of another size than the replay's rectified camera");
  }
  return image;
}

/// How often the ground, and what stands on it, was seen in each cell.
struct Seen {
  explicit Seen(std::size_t cells) : ground(cells, 0), standing(cells, 0) {}
  std::vector<int> ground;
  std::vector<int> standing;
};

void look(const cv::Mat& depth, const cv::Mat& movers, const StereoCamera& camera,
          const Pose& T_map_robot, const eval::GridCells& grid, const ObstacleHeights& heights,
          Seen& seen) {
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const double z = depth.at<std::uint16_t>(v, u) / kDepthUnit;
      if (z <= 0.0 || z > kReach_m || movers.at<std::uint8_t>(v, u) != 0) continue;
      const Eigen::Vector3d in_robot =
          camera.T_robot_cam * (z * ray(Eigen::Vector2d(u, v), camera));
      const Eigen::Vector3d in_map = T_map_robot * in_robot;
      const auto cell = grid.at(in_map.head<2>());
      if (!cell) continue;
      // The ground is level there; the robot pitches and rolls.
      const double height = in_map.z() - T_map_robot.translation().z();
      if (height < kGround_m) ++seen.ground[*cell];
      if (height >= heights.lowest && height <= heights.highest) ++seen.standing[*cell];
    }
  }
}

/// Marks the cells under a moving box.
void tread(const Track& object, const eval::GridCells& grid, std::vector<std::uint8_t>& trodden) {
  const double along = 0.5 * object.size.x() + kTreadMargin_m;
  const double across = 0.5 * object.size.y() + kTreadMargin_m;
  const Eigen::Vector2d front(std::cos(object.yaw), std::sin(object.yaw));
  const Eigen::Vector2d left(-front.y(), front.x());
  const double step = 0.5 * grid.resolution_m;
  for (double a = -along; a <= along; a += step) {
    for (double b = -across; b <= across; b += step) {
      const auto cell = grid.at(object.position.head<2>() + a * front + b * left);
      if (cell) trodden[*cell] = 1;
    }
  }
}

}  // namespace

GridTruth gridTruth(const fs::path& folder, const StereoCamera& camera, const eval::GridCells& grid,
                    const ObstacleHeights& heights) {
  GridTruth truth{grid, std::vector<std::uint8_t>(grid.states.size(), 0)};
  const auto poses = io::readTum((folder / "trajectory.tum").string());
  Seen seen(grid.states.size());
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    look(readImage(numbered(folder / "depth", frame), camera),
         readImage(numbered(folder / "masks", frame), camera), camera, poses[frame].value, grid,
         heights, seen);
  }
  for (std::size_t i = 0; i < grid.states.size(); ++i) {
    truth.cells.states[i] = seen.standing[i] >= kLeastSeen ? eval::CellState::kOccupied
                            : seen.ground[i] >= kLeastSeen ? eval::CellState::kFree
                                                           : eval::CellState::kUnknown;
  }
  for (const auto& sample : io::readTrackCsv((folder / "objects.csv").string())) {
    if (isMoving(sample.track)) tread(sample.track, grid, truth.trodden);
  }
  return truth;
}

}  // namespace headway::app
