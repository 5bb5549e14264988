// SPDX-License-Identifier: BSD-3-Clause
#include "depth_scan_crop.h"

#include <algorithm>
#include <cmath>

#include "scan_view.h"

namespace headway::map {
namespace {

constexpr double kBoxMargin_m = 0.15;       // of boxes and poses
constexpr double kMaxBack_s = 1.0;          // before a track was first seen
constexpr double kFirstVelocity_s = 0.5;    // from its first point, by which its velocity is known
constexpr double kVelocityError_mps = 0.3;  // by its change
constexpr double kSameTime_s = 1e-3;
constexpr double kDepthSigmas = 3.0;
constexpr double kNearest_m = 0.1;  // from which a box is projected

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
    if (p.z() < kNearest_m) {
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

DepthScan cropped(const DepthScan& scan, const Pose& T_map_robot, const Eigen::AlignedBox3d& box) {
  std::vector<bool> is_inside;
  ScanView(scan, T_map_robot, {0.0, 0.0})
      .forEachPoint([&](const Eigen::Vector3f& point, const Eigen::Vector3f&, float) {
        is_inside.push_back(box.contains(point.cast<double>()));
      });
  return kept(scan, is_inside);
}

std::optional<UprightBox> pastBox(const Track& track, Time time) {
  const auto& path = track.recent_path;
  if (path.size() < 2 || time > path.back().time) return std::nullopt;
  UprightBox box{positionAt(path, time), track.size, track.yaw, kBoxMargin_m};
  const double back = path.front().time - time;
  if (back <= 0.0) return box;
  const bool is_first = path.front().time <= track.first_seen + kSameTime_s;
  const double followed = path.back().time - path.front().time;
  if (!is_first || back > std::min(kMaxBack_s, followed)) return std::nullopt;
  const double span = std::min(kFirstVelocity_s, followed);
  const Eigen::Vector3d ahead = positionAt(path, path.front().time + span) - path.front().position;
  box.centre -= back / span * ahead;
  box.margin_m += kVelocityError_mps * back;
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
