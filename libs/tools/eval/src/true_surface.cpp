// SPDX-License-Identifier: BSD-3-Clause
#include <headway/eval/true_surface.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace headway::eval {
namespace {

constexpr int kKeyBits = 21;
constexpr std::int64_t kMiddle = 1 << 20;
constexpr double kBeyond = 1.5;            // of the reach, seen but not within it
constexpr std::uint32_t kMaxPixels = 400;  // of a patch: more do not change its plane
constexpr std::uint32_t kMinPlanePixels = 8;

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
  if (sums.pixels < kMaxPixels) {
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
      if (!(z > 0.0 && z <= kBeyond * to_m_) || moving[u] != 0) continue;
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
    if (sums.pixels >= kMinPlanePixels) {
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

}  // namespace headway::eval
