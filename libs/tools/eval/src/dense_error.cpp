// SPDX-License-Identifier: BSD-3-Clause
// Errors of dense maps against the true surface.
#include <headway/core/statistics.h>
#include <headway/eval/dense_error.h>
#include <headway/eval/figures.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <unordered_map>

namespace headway::eval {
namespace {

constexpr int kKeyBits = 21;
constexpr std::int64_t kMiddle = 1 << 20;

bool hasSize(const cv::Mat& image, const StereoCamera& camera) {
  return image.cols == camera.width && image.rows == camera.height;
}

/// Flat piece of the surface with the moments of a patch.
void fitPlane(const Eigen::Matrix3f& covariance, TrueSurface::Patch& patch) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver(covariance);
  patch.axes = solver.eigenvectors();  // in increasing order of the variance
  const Eigen::Vector3f variances = solver.eigenvalues().cwiseMax(0.0F);
  // Of pixels spread evenly, the half size is sqrt(3) standard deviations; along the normal it is
  // roughness, and none of it is subtracted from a distance.
  patch.half_size = {0.0F, std::sqrt(3.0F * variances[1]), std::sqrt(3.0F * variances[2])};
}

double distanceTo(const TrueSurface::Patch& patch, const Eigen::Vector3d& point) {
  const Eigen::Vector3f offset = (point - patch.centre).cast<float>() - patch.mean;
  const Eigen::Vector3f along = (patch.axes.transpose() * offset).cwiseAbs();
  return static_cast<double>((along - patch.half_size).cwiseMax(0.0F).norm());
}

}  // namespace

VoxelKey voxelOf(const Eigen::Vector3d& position, double voxel_m) {
  VoxelKey key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::int64_t>(std::floor(position[axis] / voxel_m)) + kMiddle;
    key =
        (key << kKeyBits) | static_cast<VoxelKey>(std::clamp<std::int64_t>(at, 0, 2 * kMiddle - 1));
  }
  return key;
}

VoxelKey shifted(VoxelKey key, int dx, int dy, int dz) {
  const auto shift = [](int steps, int bits) {
    return static_cast<VoxelKey>(static_cast<std::int64_t>(steps) * (std::int64_t{1} << bits));
  };
  return key + shift(dx, 2 * kKeyBits) + shift(dy, kKeyBits) + shift(dz, 0);  // modulo 2^64
}

TrueSurface::TrueSurface(const StereoCamera& camera, double voxel_m, double from_m, double to_m)
    : camera_(camera), voxel_m_(voxel_m), from_m_(from_m), to_m_(to_m) {}

TrueSurface::Sums& TrueSurface::sumsOf(VoxelKey key, const Eigen::Vector3d& in_map) {
  if (key != last_key_ || sums_.empty()) {
    const auto [entry, is_new] = index_.try_emplace(key, static_cast<std::uint32_t>(sums_.size()));
    if (is_new) {
      Sums sums;
      sums.centre = voxel_m_ * ((in_map / voxel_m_).array().floor() + 0.5);
      sums_.push_back(sums);
    }
    last_key_ = key;
    last_number_ = entry->second;
  }
  return sums_[last_number_];
}

void TrueSurface::addPixel(const Eigen::Vector3d& in_map, const Eigen::Vector3d& ray, double depth,
                           bool in_reach, bool matched) {
  Sums& sums = sumsOf(voxelOf(in_map, voxel_m_), in_map);
  if (sums.pixels == 0 || depth < sums.nearest_m) {
    sums.nearest_m = static_cast<float>(depth);
    sums.ray = ray.cast<float>();
  }
  if (sums.pixels < 400) {  // more do not change its plane
    const Eigen::Vector3f offset = (in_map - sums.centre).cast<float>();
    sums.point += offset;
    sums.product += offset * offset.transpose();
    ++sums.pixels;
  }
  if (in_reach && sums.last_frame != frame_) {
    sums.last_frame = frame_;
    ++sums.frames;
  }
  if (in_reach && matched && sums.last_matched_frame != frame_) {
    sums.last_matched_frame = frame_;
    ++sums.matched_frames;
  }
}

void TrueSurface::add(const TrueDepths& depths, const Pose& T_map_robot) {
  if (!hasSize(depths.depth_m, camera_) || !hasSize(depths.moving, camera_) ||
      (!depths.matched.empty() && !hasSize(depths.matched, camera_))) {
    throw std::invalid_argument("TrueSurface: the size of an image differs from the camera's");
  }
  ++frame_;
  const Pose T_map_cam = T_map_robot * camera_.T_robot_cam;
  for (int v = 0; v < depths.depth_m.rows; ++v) {
    const auto* depth = depths.depth_m.ptr<float>(v);
    const auto* moving = depths.moving.ptr<std::uint8_t>(v);
    const auto* matched = depths.matched.empty() ? nullptr : depths.matched.ptr<std::uint8_t>(v);
    for (int u = 0; u < depths.depth_m.cols; ++u) {
      const auto z = static_cast<double>(depth[u]);
      if (!(z > 0.0 && z <= 1.5 * to_m_) || moving[u] != 0) continue;
      // What the right camera does not see has no disparity.
      const double hidden_px = camera_.isDepthCamera() ? 0.0 : camera_.fx * camera_.baseline_m / z;
      const bool in_reach = z >= from_m_ && z <= to_m_ && u >= hidden_px;
      const Eigen::Vector3d along = T_map_cam.linear() * ray(Eigen::Vector2d(u, v), camera_);
      addPixel(T_map_cam.translation() + z * along, along, z, in_reach,
               matched != nullptr && matched[u] != 0);
    }
  }
}

std::vector<TrueSurface::Patch> TrueSurface::patches() const {
  std::vector<Patch> patches;
  patches.reserve(sums_.size());
  for (const Sums& sums : sums_) {
    Patch patch;
    const auto pixels = static_cast<float>(sums.pixels);
    patch.centre = sums.centre;
    patch.mean = sums.point / pixels;
    patch.nearest_m = sums.nearest_m;
    patch.ray = sums.ray.normalized();
    patch.frames = sums.frames;
    patch.matched_frames = sums.matched_frames;
    if (sums.pixels >= 8) {
      fitPlane(sums.product / pixels - patch.mean * patch.mean.transpose(), patch);
    }
    patches.push_back(patch);
  }
  return patches;
}

PatchIndex::PatchIndex(const std::vector<TrueSurface::Patch>& patches, double voxel_m)
    : patches_(patches), voxel_m_(voxel_m) {
  index_.reserve(patches.size());
  for (std::uint32_t i = 0; i < patches.size(); ++i) {
    index_.emplace(voxelOf(patches[i].centre, voxel_m), i);
  }
}

std::optional<PatchIndex::Nearest> PatchIndex::nearest(const Eigen::Vector3d& point,
                                                       int max_voxels) const {
  const VoxelKey middle = voxelOf(point, voxel_m_);
  Nearest best{nullptr, std::numeric_limits<double>::infinity()};
  for (int shell = 0; shell <= max_voxels; ++shell) {
    if (best.distance_m <= (shell - 1) * voxel_m_) break;  // all others are farther
    for (int dx = -shell; dx <= shell; ++dx) {
      for (int dy = -shell; dy <= shell; ++dy) {
        const bool is_side = std::max(std::abs(dx), std::abs(dy)) == shell;
        for (int dz = -shell; dz <= shell; dz += is_side ? 1 : 2 * shell) {
          const auto entry = index_.find(shifted(middle, dx, dy, dz));
          if (entry == index_.end()) continue;
          const auto& patch = patches_[entry->second];
          const double distance = distanceTo(patch, point);
          if (distance < best.distance_m) best = {&patch, distance};
        }
      }
    }
  }
  if (best.patch == nullptr) return std::nullopt;
  return best;
}

namespace {

constexpr std::uint32_t kMinFrames = 3;
constexpr int kMaxVoxels = 5;
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
    const bool is_off = distance > 4.0 * bar;  // 2 deviations: none of its points
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
