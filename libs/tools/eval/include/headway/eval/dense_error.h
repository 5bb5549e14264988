// SPDX-License-Identifier: BSD-3-Clause
// Errors of dense maps against the true surface.
#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
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

/// Box of a true object in one frame, in the map.
struct ObjectBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< length, width, height [m]
  double yaw = 0.0;                                  ///< [rad]
  bool moves = false;                                ///< the object moves in this or another frame
};

/// How much of the true surface has points of a dense map.
struct Coverage {
  std::size_t surface = 0;             ///< patches seen in at least 3 frames within reach
  std::size_t covered_within_bar = 0;  ///< with a point within the bar along its ray as well
  std::size_t covered = 0;             ///< of these, with a point within a voxel's side
  std::size_t matchable = 0;           ///< of the surface, of true stereo depth in 3 frames or more
  std::size_t matchable_covered = 0;

  [[nodiscard]] std::optional<double> ratio() const;             ///< covered / surface
  [[nodiscard]] std::optional<double> ratioWithinBar() const;    ///< covered_within_bar / surface
  [[nodiscard]] std::optional<double> matchableRatio() const;    ///< matchable / surface
  [[nodiscard]] std::optional<double> matchableCovered() const;  ///< matchable_covered / matchable
};

/// Comparison of a dense map with the true surface, in the frame of the map and without alignment:
/// errors of the poses count.
struct DenseError {
  static constexpr std::size_t kRanges = 4;  ///< of equal width, up to the reach

  std::size_t points = 0;
  std::size_t on_still_objects = 0;  ///< of objects that never move, whose surface is not known
  std::size_t compared = 0;          ///< all others
  double median_m = 0.0;             ///< distance to the surface, of the compared points [m]
  double median_bar_m = 0.0;   ///< larger of half a voxel and half the depth error at the least
                               ///< depth that the surface was seen at [m]
  std::size_t within_bar = 0;  ///< points whose distance is at most their bar
  std::size_t astray = 0;      ///< points more than 5 voxels from any surface
  std::size_t of_movers = 0;   ///< more than 4 bars from any surface, where a moving object was
  Coverage coverage;
  std::array<Coverage, kRanges> by_range;   ///< by the least depth that the surface was seen at
  std::vector<std::uint8_t> is_covered;     ///< of each patch: 0 no, 1 yes, 2 not within reach
  std::vector<std::uint32_t> mover_points;  ///< indices of the points of_movers

  [[nodiscard]] std::optional<double> withinBarRatio() const;  ///< of compared
  [[nodiscard]] std::optional<double> moverRatio() const;      ///< of points
};

/// @param patches           of a surface with that voxel and reach
/// @param sigma_per_square  depth error by the square of the depth [1/m]
/// @param points            of the dense map [m]
/// @param objects           what may move, in all frames
[[nodiscard]] DenseError denseError(const std::vector<TrueSurface::Patch>& patches, double voxel_m,
                                    double reach_m, double sigma_per_square,
                                    const std::vector<Eigen::Vector3d>& points,
                                    const std::vector<ObjectBox>& objects);

/// Sizes of a dense map [MB].
struct DenseSizes {
  double points_mb = 0.0;  ///< of map_dense.ply
  double scans_mb = 0.0;   ///< of the depth scans in map.headway, uncompressed
  double path_km = 0.0;    ///< that they are of

  [[nodiscard]] std::optional<double> perKilometre() const;  ///< both; nullopt without a path
};

/// Errors of a replay's dense map, with what was compared.
struct DenseEvaluation {
  std::vector<TrueSurface::Patch> patches;  ///< the true surface
  std::vector<Eigen::Vector3d> points;      ///< of map_dense.ply [m]
  DenseError error;
  DenseSizes sizes;
  double voxel_m = 0.0;
  double reach_m = 0.0;     ///< that the replay claims
  bool is_matched = false;  ///< the pairs of the rawlog were matched

  /// Least depths of the surface in one of DenseError's ranges [m].
  [[nodiscard]] std::array<double, 2> rangeLimits(std::size_t range) const;
};

/// Evaluates a replay of a whole simulated rawlog as `headway-eval dense` does.
///
/// @param truth   folder written by headway-sim --depth --masks
/// @param replay  with map_dense.ply, map.headway, replay.json and calibration.yaml
/// @param rawlog  of that truth, to match its pairs as the replay did; empty: not matched
/// @throws InputError if a file is missing, damaged or does not match the others
[[nodiscard]] DenseEvaluation evaluateDense(const std::filesystem::path& truth,
                                            const std::filesystem::path& replay,
                                            const std::string& rawlog);

/// The figures of `headway-eval dense --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const DenseEvaluation& evaluation);

}  // namespace headway::eval
