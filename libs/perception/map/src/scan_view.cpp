// SPDX-License-Identifier: BSD-3-Clause
// A depth scan seen from its camera: its surfaces, the depth in a direction, and parts of it.
#include "scan_view.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace headway::map {
namespace {

constexpr float kBeyond = 1.5F;       // of the greatest depth, what a scan can say about points
constexpr double kMaxGradient = 0.5;  // of a surface's disparity, which is b / h on the ground
constexpr int kMaxSteps = 16;  // between two cells: more would be beyond the voxel of any map

constexpr double kSameTime_s = 1e-3;  // less than between frames

/// The cells of a scan of which `keep` has an entry for each known one.
DepthScan kept(const DepthScan& scan, const std::vector<bool>& keep) {
  DepthScan part;
  part.time = scan.time;
  part.grid = scan.grid;
  part.known.assign(scan.known.size(), 0);
  const std::size_t channels = scan.hasColour() ? 3 : 1;
  std::size_t point = 0;
  for (std::size_t cell = 0; cell < scan.grid.cells(); ++cell) {
    if (!scan.isKnown(cell)) continue;
    const std::size_t at = point++;
    if (!keep[at]) continue;
    part.known[cell / 8] |= static_cast<std::uint8_t>(1U << (cell % 8));
    part.disparity.push_back(scan.disparity[at]);
    const auto colour = scan.colour.begin() + static_cast<std::ptrdiff_t>(channels * at);
    part.colour.insert(part.colour.end(), colour, colour + static_cast<std::ptrdiff_t>(channels));
  }
  return part;
}

/// A box as a scan sees it.
struct BoxInView {
  Eigen::AlignedBox2d cells;  ///< columns and rows
  Pose T_box_cam = Pose::Identity();
  Eigen::Vector3d half_size = Eigen::Vector3d::Zero();  ///< [m]
};

/// nullopt if a box is out of view; one that reaches behind the camera may be anywhere in view.
std::optional<BoxInView> inView(const UprightBox& box, const Pose& T_odom_cam,
                                const DepthScanGrid& grid) {
  Pose T_odom_box = Pose::Identity();
  T_odom_box.translate(box.centre).rotate(Eigen::AngleAxisd(box.yaw, Eigen::Vector3d::UnitZ()));
  BoxInView seen;
  seen.T_box_cam = T_odom_box.inverse() * T_odom_cam;
  const double depth = (T_odom_cam.inverse() * box.centre).z();
  const double sigma = grid.sigma_disparity_px / grid.focal_baseline * depth * depth;
  const double margin = box.margin_m + kDepthSigmas * sigma;
  seen.half_size = 0.5 * box.size + Eigen::Vector3d::Constant(margin);
  if (depth < -seen.half_size.norm()) return std::nullopt;
  const Eigen::AlignedBox2d all(Eigen::Vector2d::Zero(),
                                Eigen::Vector2d(grid.columns - 1, grid.rows - 1));
  const Eigen::AlignedBox3d corners(-seen.half_size, seen.half_size);
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d p =
        seen.T_box_cam.inverse() * corners.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
    if (p.z() < kMinDepth) {
      seen.cells = all;
      return seen;
    }
    seen.cells.extend(Eigen::Vector2d((grid.fx * p.x() / p.z() + grid.cx - grid.u0) / grid.step_u,
                                      (grid.fy * p.y() / p.z() + grid.cy - grid.v0) / grid.step_v));
  }
  if (!seen.cells.intersects(all)) return std::nullopt;
  return seen;
}

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

DepthScan cropped(const DepthScan& scan, const Pose& T_map_robot, const Eigen::AlignedBox3d& box) {
  std::vector<bool> is_inside;
  ScanView(scan, T_map_robot, {0.0, 0.0})
      .forEachPoint([&](const Eigen::Vector3f& point, const Eigen::Vector3f&, float) {
        is_inside.push_back(box.contains(point.cast<double>()));
      });
  return kept(scan, is_inside);
}

std::optional<UprightBox> pastBox(const Track& track, Time time, const PastBoxParams& params) {
  const auto& path = track.recent_path;
  if (path.size() < 2 || time > path.back().time) return std::nullopt;
  UprightBox box{positionAt(path, time), track.size, track.yaw, params.margin_m};
  const double back = path.front().time - time;
  if (back <= 0.0) return box;
  const bool is_first = path.front().time <= track.first_seen + kSameTime_s;
  const double followed = path.back().time - path.front().time;
  if (!is_first || back > std::min(params.max_back_s, followed)) return std::nullopt;
  const double span = std::min(params.first_velocity_s, followed);
  const Eigen::Vector3d ahead = positionAt(path, path.front().time + span) - path.front().position;
  box.centre -= back / span * ahead;
  box.margin_m += params.velocity_error_mps * back;
  return box;
}

std::optional<DepthScan> without(const DepthScan& scan, const Pose& T_odom_robot,
                                 const std::vector<UprightBox>& boxes) {
  const DepthScanGrid& grid = scan.grid;
  const Pose T_odom_cam = T_odom_robot * grid.T_robot_cam;
  std::vector<BoxInView> seen;
  for (const auto& box : boxes) {
    if (const auto in_view = inView(box, T_odom_cam, grid)) seen.push_back(*in_view);
  }
  if (seen.empty()) return std::nullopt;
  const auto isInBox = [&](const Eigen::Vector2d& cell, double disparity) {
    const double depth = grid.focal_baseline * DepthScan::kUnitsPerPx / disparity;
    const double u = grid.u0 + grid.step_u * cell.x(), v = grid.v0 + grid.step_v * cell.y();
    const Eigen::Vector3d ray((u - grid.cx) / grid.fx, (v - grid.cy) / grid.fy, 1.0);
    return std::any_of(seen.begin(), seen.end(), [&](const BoxInView& box) {
      if (!box.cells.contains(cell)) return false;
      const Eigen::Vector3d point = box.T_box_cam * (depth * ray);
      return (point.cwiseAbs().array() <= box.half_size.array()).all();
    });
  };
  std::vector<bool> keep;
  keep.reserve(scan.disparity.size());
  std::size_t cell = 0;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (!scan.isKnown(cell++)) continue;
      keep.push_back(!isInBox(Eigen::Vector2d(column, row), scan.disparity[keep.size()]));
    }
  }
  if (std::find(keep.begin(), keep.end(), false) == keep.end()) return std::nullopt;
  return kept(scan, keep);
}

}  // namespace headway::map
