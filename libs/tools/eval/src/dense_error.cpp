// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/statistics.h>
#include <headway/eval/dense_error.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "label_matching.h"

namespace headway::eval {
namespace {

constexpr std::uint32_t kMinFrames = 3;
constexpr int kMaxVoxels = 5;
constexpr double kOffBars = 4.0;      // from a surface, what is none of its points: 2 deviations
constexpr double kBoxMargin_m = 0.2;  // true boxes are tight

/// Boxes by the squares of the ground that they touch.
class BoxIndex {
 public:
  explicit BoxIndex(const std::vector<ObjectBox>& boxes) : boxes_(boxes) {
    for (std::uint32_t i = 0; i < boxes.size(); ++i) {
      const double radius = 0.5 * boxes[i].size.head<2>().norm() + kBoxMargin_m;
      const Eigen::Array2d min = boxes[i].centre.head<2>().array() - radius;
      const Eigen::Array2d max = boxes[i].centre.head<2>().array() + radius;
      for (double x = kSide_m * std::floor(min.x() / kSide_m); x <= max.x(); x += kSide_m) {
        for (double y = kSide_m * std::floor(min.y() / kSide_m); y <= max.y(); y += kSide_m) {
          squares_[keyOf({x + 0.5 * kSide_m, y + 0.5 * kSide_m, 0.0})].push_back(i);
        }
      }
    }
  }

  /// Whether a point is in a box of an object that moves, or in one of an object that never does.
  [[nodiscard]] bool isIn(const Eigen::Vector3d& point, bool moves) const {
    const auto square = squares_.find(keyOf(point));
    if (square == squares_.end()) return false;
    return std::any_of(square->second.begin(), square->second.end(), [&](std::uint32_t i) {
      return boxes_[i].moves == moves && contains(boxes_[i], point);
    });
  }

 private:
  static constexpr double kSide_m = 2.0;

  static VoxelKey keyOf(const Eigen::Vector3d& point) {
    return voxelOf({point.x(), point.y(), 0.0}, kSide_m);
  }
  static bool contains(const ObjectBox& box, const Eigen::Vector3d& point) {
    const Eigen::Vector3d offset =
        Eigen::AngleAxisd(-box.yaw, Eigen::Vector3d::UnitZ()) * (point - box.centre);
    return ((offset.cwiseAbs() - 0.5 * box.size).array() <= kBoxMargin_m).all();
  }

  const std::vector<ObjectBox>& boxes_;
  std::unordered_map<VoxelKey, std::vector<std::uint32_t>, VoxelKeyHash> squares_;
};

/// Points by voxels.
class PointIndex {
 public:
  PointIndex(const std::vector<Eigen::Vector3d>& points, double voxel_m)
      : points_(points), voxel_m_(voxel_m) {
    for (std::uint32_t i = 0; i < points.size(); ++i) {
      voxels_[voxelOf(points[i], voxel_m)].push_back(i);
    }
  }

  /// Whether a point is within a voxel's side of a ray through a position, and as near to the
  /// position along the ray as `along_m`.
  [[nodiscard]] bool hasNearRay(const Eigen::Vector3d& position, const Eigen::Vector3d& ray,
                                double along_m) const {
    for (double at = -along_m; at <= along_m; at += voxel_m_) {
      if (hasNear(position + at * ray)) return true;
    }
    return false;
  }

  /// Whether a point is within a voxel's side of a position.
  [[nodiscard]] bool hasNear(const Eigen::Vector3d& position) const {
    const VoxelKey middle = voxelOf(position, voxel_m_);
    for (int dx = -1; dx <= 1; ++dx) {
      for (int dy = -1; dy <= 1; ++dy) {
        for (int dz = -1; dz <= 1; ++dz) {
          const auto voxel = voxels_.find(shifted(middle, dx, dy, dz));
          if (voxel == voxels_.end()) continue;
          for (const auto i : voxel->second) {
            if ((points_[i] - position).squaredNorm() <= voxel_m_ * voxel_m_) return true;
          }
        }
      }
    }
    return false;
  }

 private:
  const std::vector<Eigen::Vector3d>& points_;
  double voxel_m_;
  std::unordered_map<VoxelKey, std::vector<std::uint32_t>, VoxelKeyHash> voxels_;
};

/// The larger of half a voxel and half the depth error at the least depth it was seen at [m].
double barOf(const TrueSurface::Patch& patch, double voxel_m, double sigma_per_square) {
  const auto range = static_cast<double>(patch.nearest_m);
  return 0.5 * std::max(voxel_m, sigma_per_square * square(range));
}

void count(bool is_covered, bool is_within_bar, bool is_matchable, Coverage& coverage) {
  ++coverage.surface;
  if (is_within_bar) ++coverage.covered_within_bar;
  if (is_covered) ++coverage.covered;
  if (is_matchable) ++coverage.matchable;
  if (is_matchable && is_covered) ++coverage.matchable_covered;
}

void compareSurface(const std::vector<TrueSurface::Patch>& patches, double voxel_m, double reach_m,
                    double sigma_per_square, const std::vector<Eigen::Vector3d>& points,
                    DenseError& error) {
  const PointIndex index(points, voxel_m);
  for (const auto& patch : patches) {
    if (patch.frames < kMinFrames) {
      error.is_covered.push_back(2);
      continue;
    }
    const bool is_covered = index.hasNear(patch.position());
    error.is_covered.push_back(is_covered ? 1 : 0);
    const bool is_matchable = patch.matched_frames >= kMinFrames;
    const double bar = barOf(patch, voxel_m, sigma_per_square);
    const bool is_within_bar =
        is_covered || index.hasNearRay(patch.position(), patch.ray.cast<double>(), bar);
    count(is_covered, is_within_bar, is_matchable, error.coverage);
    const double range = DenseError::kRanges * static_cast<double>(patch.nearest_m) / reach_m;
    const auto last = DenseError::kRanges - 1;
    count(is_covered, is_within_bar, is_matchable,
          error.by_range[std::min(last, static_cast<std::size_t>(range))]);
  }
}

}  // namespace

std::optional<double> Coverage::ratio() const { return ratioOf(covered, surface); }
std::optional<double> Coverage::ratioWithinBar() const {
  return ratioOf(covered_within_bar, surface);
}
std::optional<double> Coverage::matchableRatio() const { return ratioOf(matchable, surface); }
std::optional<double> Coverage::matchableCovered() const {
  return ratioOf(matchable_covered, matchable);
}
std::optional<double> DenseError::withinBarRatio() const { return ratioOf(within_bar, compared); }
std::optional<double> DenseError::moverRatio() const { return ratioOf(of_movers, points); }

DenseError denseError(const std::vector<TrueSurface::Patch>& patches, double voxel_m,
                      double reach_m, double sigma_per_square,
                      const std::vector<Eigen::Vector3d>& points,
                      const std::vector<ObjectBox>& objects) {
  DenseError error;
  error.points = points.size();
  const PatchIndex surface(patches, voxel_m);
  const BoxIndex boxes(objects);
  std::vector<double> distances, bars;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const auto nearest = surface.nearest(points[i], kMaxVoxels);
    const double distance = nearest ? nearest->distance_m : kMaxVoxels * voxel_m;
    const double bar = nearest ? barOf(*nearest->patch, voxel_m, sigma_per_square) : 0.5 * voxel_m;
    const bool is_off = distance > kOffBars * bar;
    if (is_off && boxes.isIn(points[i], true)) {
      error.mover_points.push_back(i);
    } else if (is_off && boxes.isIn(points[i], false)) {
      ++error.on_still_objects;
      continue;
    }
    distances.push_back(distance);
    bars.push_back(bar);
    if (distance <= bar) ++error.within_bar;
    if (!nearest) ++error.astray;
  }
  error.of_movers = error.mover_points.size();
  error.compared = distances.size();
  error.median_m = median(std::move(distances));
  error.median_bar_m = median(std::move(bars));
  compareSurface(patches, voxel_m, reach_m, sigma_per_square, points, error);
  return error;
}

}  // namespace headway::eval
