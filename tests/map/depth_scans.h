// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/random.h>
#include <headway/core/scan.h>

#include <cmath>
#include <optional>

namespace headway::map {

/// Ground at z = 0, a wall at x = 12 m, and a box of 1 x 1 x 1 m on the ground, if there is one.
struct DepthWorld {
  std::optional<Eigen::Vector3d> box;  ///< centre of its lower face [m]
  double noise_px = 0.0;               ///< of disparities
  std::uint64_t seed = 1;
  bool with_colour = true;
};

inline constexpr double kWallX = 12.0;

inline Pose robotAt(double x, double y, double yaw = 0.0) {
  return Eigen::Translation3d(x, y, 0.0) * Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ());
}

/// Grid of a camera 1 m above the ground.
inline DepthScanGrid depthGrid() {
  DepthScanGrid grid;
  grid.columns = 160;
  grid.rows = 120;
  grid.u0 = grid.v0 = 1.5;
  grid.step_u = grid.step_v = 4.0;
  grid.fx = grid.fy = 500.0;
  grid.cx = 320.0;
  grid.cy = 240.0;
  grid.focal_baseline = 150.0;
  grid.sigma_disparity_px = 0.3;
  grid.T_robot_cam = Eigen::Translation3d(0.0, 0.0, 1.0) * robotFromOptical();
  return grid;
}

/// Distance along a ray to a box of the world's size; nullopt beside it.
inline std::optional<double> hitOfBox(const Eigen::Vector3d& from, const Eigen::Vector3d& ray,
                                      const Eigen::Vector3d& foot) {
  const Eigen::Vector3d min = foot - Eigen::Vector3d(0.5, 0.5, 0.0);
  const Eigen::Array3d a = (min - from).array() / ray.array();
  const Eigen::Array3d b = (min + Eigen::Vector3d::Ones() - from).array() / ray.array();
  const double enters = a.min(b).maxCoeff();
  const double leaves = a.max(b).minCoeff();
  return enters > 0.0 && enters < leaves ? std::optional(enters) : std::nullopt;
}

/// What a robot sees of the world up to 15 m: grey ground, a red wall, a blue box.
inline DepthScan depthScanFrom(const Pose& T_map_robot, const DepthWorld& world = {}) {
  DepthScan scan;
  scan.grid = depthGrid();
  const DepthScanGrid& grid = scan.grid;
  scan.known.assign((grid.cells() + 7) / 8, 0);
  const Pose T_map_cam = T_map_robot * grid.T_robot_cam;
  const Eigen::Vector3d from = T_map_cam.translation();
  Random random(world.seed);
  for (std::size_t cell = 0; cell < grid.cells(); ++cell) {
    const double u = grid.u0 + grid.step_u * static_cast<double>(cell % 160);
    const double v = grid.v0 + grid.step_v * static_cast<double>(cell / 160);
    const Eigen::Vector3d ray =
        T_map_cam.linear() * Eigen::Vector3d((u - grid.cx) / grid.fx, (v - grid.cy) / grid.fy, 1);
    double depth = 1e9;
    std::array<std::uint8_t, 3> colour{};
    const auto see = [&](double at, std::array<std::uint8_t, 3> of) {
      if (at > 0.0 && at < depth) {
        depth = at;
        colour = of;
      }
    };
    see(-from.z() / ray.z(), {100, 100, 100});
    see((kWallX - from.x()) / ray.x(), {200, 50, 50});
    if (world.box) see(hitOfBox(from, ray, *world.box).value_or(-1.0), {50, 50, 200});
    const double disparity = grid.focal_baseline / depth + world.noise_px * random.normal();
    if (!(disparity > grid.focal_baseline / 15.0)) continue;
    scan.known[cell / 8] |= static_cast<std::uint8_t>(1U << (cell % 8));
    scan.disparity.push_back(
        static_cast<std::uint16_t>(std::lround(disparity * DepthScan::kUnitsPerPx)));
    scan.colour.insert(scan.colour.end(), colour.begin(),
                       world.with_colour ? colour.end() : colour.begin() + 1);
  }
  return scan;
}

}  // namespace headway::map
