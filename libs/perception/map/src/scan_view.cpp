// SPDX-License-Identifier: BSD-3-Clause
#include "scan_view.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace headway::map {
namespace {

constexpr float kBeyond = 1.5F;       // of the greatest depth, what a scan can say about points
constexpr double kMaxGradient = 0.5;  // of a surface's disparity, which is b / h on the ground
constexpr int kMaxSteps = 16;

}  // namespace

ScanView::ScanView(const DepthScan& scan, const Pose& T_map_robot, const Eigen::Vector2d& corner)
    : scan_(scan),
      columns_(static_cast<std::size_t>(scan.grid.columns)),
      rows_(static_cast<std::size_t>(scan.grid.rows)),
      disparity_(scan.grid.cells(), 0) {
  const DepthScanGrid& grid = scan.grid;
  const Pose T_map_cam = T_map_robot * grid.T_robot_cam;
  R_tile_cam_ = T_map_cam.linear().cast<float>();
  const Eigen::Vector3d origin(corner.x(), corner.y(), 0.0);
  camera_ = (T_map_cam.translation() - origin).cast<float>();
  ray_first_ =
      Eigen::Vector2d((grid.u0 - grid.cx) / grid.fx, (grid.v0 - grid.cy) / grid.fy).cast<float>();
  ray_step_ = Eigen::Vector2d(grid.step_u / grid.fx, grid.step_v / grid.fy).cast<float>();
  inverse_step_ = ray_step_.cwiseInverse();
  focal_baseline_ = static_cast<float>(grid.focal_baseline * DepthScan::kUnitsPerPx);
  sigma_factor_ = static_cast<float>(grid.sigma_disparity_px / grid.focal_baseline);
  std::size_t next = 0;
  std::uint16_t least = 0xffffU;
  for (std::size_t cell = 0; cell < disparity_.size() && next < scan.disparity.size(); ++cell) {
    if (!scan.isKnown(cell)) continue;
    disparity_[cell] = scan.disparity[next++];
    least = std::min(least, disparity_[cell]);
  }
  max_depth_ = kBeyond * depthOf(static_cast<float>(std::max<std::uint16_t>(least, 1)));
  markSmooth();
}

void ScanView::markSmooth() {
  is_smooth_.assign(disparity_.size(), 0);
  const auto limitOf = [&](double step_px) {
    return static_cast<int>(kMaxGradient * step_px * DepthScan::kUnitsPerPx);
  };
  const int max_across = limitOf(scan_.grid.step_u);
  const int max_down = limitOf(scan_.grid.step_v);
  for (std::size_t row = 0; row + 1 < rows_; ++row) {
    for (std::size_t column = 0; column + 1 < columns_; ++column) {
      const std::size_t cell = row * columns_ + column;
      const int corner = disparity_[cell], right = disparity_[cell + 1];
      const int below = disparity_[cell + columns_], across = disparity_[cell + columns_ + 1];
      is_smooth_[cell] =
          corner != 0 && right != 0 && below != 0 && across != 0 &&
          std::abs(right - corner) <= max_across && std::abs(across - below) <= max_across &&
          std::abs(below - corner) <= max_down && std::abs(across - right) <= max_down;
    }
  }
}

std::array<int, 2> ScanView::stepsBetween(std::size_t cell, float spacing) const {
  if (is_smooth_[cell] == 0) return {1, 1};
  const auto pointOf = [&](std::size_t of) {
    return inCamera(columnOf(of), rowOf(of), depthOf(static_cast<float>(disparity_[of])));
  };
  const Eigen::Vector3f corner = pointOf(cell);
  const auto stepsTo = [&](std::size_t other) {
    const float steps = std::ceil((pointOf(other) - corner).norm() / spacing);
    return std::clamp(static_cast<int>(steps), 1, kMaxSteps);
  };
  return {stepsTo(cell + 1), stepsTo(cell + columns_)};
}

float ScanView::nearestRound(const Look& look) const {
  const std::size_t column = look.cell % columns_;
  const std::size_t row = look.cell / columns_;
  if (column == 0 || row == 0 || column + 1 == columns_ || row + 1 == rows_) return 0.0F;
  std::uint16_t greatest = 0;
  for (std::size_t r = row - 1; r <= row + 1; ++r) {
    for (std::size_t c = column - 1; c <= column + 1; ++c) {
      const std::uint16_t disparity = disparity_[r * columns_ + c];
      if (disparity == 0) return 0.0F;
      greatest = std::max(greatest, disparity);
    }
  }
  return depthOf(static_cast<float>(greatest));
}

}  // namespace headway::map
