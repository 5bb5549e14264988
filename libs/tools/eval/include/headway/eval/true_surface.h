// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <unordered_map>
#include <vector>

namespace headway::eval {

/// Index of a cube of space, which contains its lower faces.
using VoxelKey = std::uint64_t;

/// @param position  at most 2^20 voxels from the origin along each axis [m]
[[nodiscard]] VoxelKey voxelOf(const Eigen::Vector3d& position, double voxel_m);

/// The voxel beside another one.
[[nodiscard]] VoxelKey shifted(VoxelKey key, int dx, int dy, int dz);

/// Spreads the bits of a key over those that an unordered_map uses.
struct VoxelKeyHash {
  std::size_t operator()(VoxelKey key) const {
    return (key * 0x9e3779b97f4a7c15ULL) >> 20U;  // Knuth's multiplicative hash
  }
};

/// True depths of one frame, in the left rectified image.
struct TrueDepths {
  cv::Mat depth_m;  ///< 32-bit float [m], 0 where there is none
  cv::Mat moving;   ///< 8-bit, non-zero on what may move
  cv::Mat matched;  ///< 8-bit, non-zero where stereo gives the true depth; empty: not asked
};

/// The static surface that a camera truly saw along its path, in patches of a voxel each.
///
///     TrueSurface surface(camera, 0.1, 3.0, 20.0);
///     for (const auto& frame : frames) surface.add(frame.depths, frame.T_map_robot);
///     const auto nearest = surface.nearest(point, 5);
class TrueSurface {
 public:
  /// What was seen in a voxel.
  struct Patch {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();       ///< from the centre of its voxel [m]
    Eigen::Matrix3f axes = Eigen::Matrix3f::Identity();   ///< columns; the first is its normal
    Eigen::Vector3f half_size = Eigen::Vector3f::Zero();  ///< along its axes [m]; 0 if unknown
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();     ///< of its voxel [m]
    float nearest_m = 0.0F;                               ///< least depth it was seen at [m]
    Eigen::Vector3f ray = Eigen::Vector3f::Zero();        ///< unit vector of that view
    std::uint32_t frames = 0;          ///< in which both cameras saw it within reach
    std::uint32_t matched_frames = 0;  ///< of these, in which stereo gave its true depth

    [[nodiscard]] Eigen::Vector3d position() const { return centre + mean.cast<double>(); }
  };

  /// @param from_m, to_m  depths within the reach of the camera [m]
  TrueSurface(const StereoCamera& camera, double voxel_m, double from_m, double to_m);

  /// Adds what a frame shows up to 1.5 times the reach.
  ///
  /// @throws std::invalid_argument if an image does not have the camera's size
  void add(const TrueDepths& depths, const Pose& T_map_robot);

  [[nodiscard]] double voxel() const { return voxel_m_; }
  [[nodiscard]] double reach() const { return to_m_; }
  /// In the order in which they were first seen.
  [[nodiscard]] std::vector<Patch> patches() const;

 private:
  /// Sums over the pixels in a voxel, relative to its centre.
  struct Sums {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    Eigen::Vector3f point = Eigen::Vector3f::Zero();
    Eigen::Matrix3f product = Eigen::Matrix3f::Zero();
    float nearest_m = 0.0F;
    Eigen::Vector3f ray = Eigen::Vector3f::Zero();
    std::uint32_t pixels = 0;
    std::uint32_t frames = 0, last_frame = 0;
    std::uint32_t matched_frames = 0, last_matched_frame = 0;
  };
  void addPixel(const Eigen::Vector3d& in_map, const Eigen::Vector3d& ray, double depth,
                bool in_reach, bool matched);
  Sums& sumsOf(VoxelKey key, const Eigen::Vector3d& in_map);

  StereoCamera camera_;
  double voxel_m_, from_m_, to_m_;
  std::uint32_t frame_ = 0;  ///< number of the last one, from 1
  std::unordered_map<VoxelKey, std::uint32_t, VoxelKeyHash> index_;
  std::vector<Sums> sums_;
  VoxelKey last_key_ = 0;  ///< of the last pixel: its neighbour is mostly in the same voxel
  std::uint32_t last_number_ = 0;
};

/// Patches by their place.
class PatchIndex {
 public:
  /// @param patches  must outlive this object
  PatchIndex(const std::vector<TrueSurface::Patch>& patches, double voxel_m);

  /// A patch and its distance from a point.
  struct Nearest {
    const TrueSurface::Patch* patch;
    double distance_m;
  };
  /// The patch nearest to a point: distances are those to the flat piece of its size.
  ///
  /// @param max_voxels  no patch is farther from the point's voxel, along each axis
  [[nodiscard]] std::optional<Nearest> nearest(const Eigen::Vector3d& point, int max_voxels) const;

 private:
  const std::vector<TrueSurface::Patch>& patches_;
  double voxel_m_;
  std::unordered_map<VoxelKey, std::uint32_t, VoxelKeyHash> index_;
};

}  // namespace headway::eval
