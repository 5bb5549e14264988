// SPDX-License-Identifier: BSD-3-Clause
// The dense coloured map: which depth scans are stored, and which tiles are fused anew.
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/params.h>
#include <headway/core/scan.h>
#include <headway/core/track.h>
#include <headway/map/anchored_pose.h>
#include <mrpt/maps/CColouredPointsMap.h>

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace headway::map {

struct DenseTile;

/// Parameters of the dense map. Section [dense]; 0 stands for the value of the rig.
struct DenseMapParams {
  bool use = true;
  double voxel_m = 0.0;    ///< side of a voxel [m]
  double reach_m = 0.0;    ///< maximum depth of the surfaces that enter it [m]
  double spacing_m = 0.0;  ///< between the places whose scans are stored [m]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "dense"); }  ///< @throws InputError
};

/// Dense coloured map of the static world: depth scans, fused to at most one point in a voxel.
/// Copies share scans and points.
///
/// The last scan of each place and direction is stored, anchored to the nearest keyframe: memory
/// grows with the area and not with time, and the map follows every correction. The points are a
/// function of the scans and their poses. They are fused in square tiles, each when it is asked for
/// after one of its scans has changed:
///
///   1. The voxels that the surfaces of a scan hit, also between its cells, are candidates.
///   2. Each scan that looks at a candidate agrees with it, if it measured the same depth within
///      three standard deviations, or sees through it, if it measured a greater one. Evidence is
///      summed in order of time within limits, so that what has left is removed by the scans that
///      see through its place, and what has come is entered, by one scan if none saw through.
///   3. Candidates are moved along the rays to the mean depth of the scans that agree, weighted by
///      inverse variance, which makes thin surfaces of noisy ones; single points are removed.
///
///     DenseMap dense(params);
///     dense.follow(slam.map().keyframes);   // after each keyframe
///     dense.add(T_map_robot, scan);         // of frames, as often as wanted
///     map.update(dense.layer());
///
/// @see  Merrell et al. 2007, "Real-time visibility-based fusion of depth maps"; Hornung et al.
///       2013, "OctoMap" (evidence within limits)
class DenseMap {
 public:
  /// @param params  of a rig: without 0, unless nothing is added or loaded
  explicit DenseMap(const DenseMapParams& params);

  /// Adds a scan in place of the last one from the same place and direction. One without depths is
  /// ignored.
  void add(const Pose& T_map_robot, DepthScan scan) {
    add(anchored(T_map_robot), T_map_robot, std::move(scan));
  }

  /// The same of a frame that was processed before: its poses when it was, and its scan.
  [[nodiscard]] AnchoredPose anchored(const Pose& T_map_robot) const;
  void add(AnchoredPose pose, const Pose& T_odom_robot, DepthScan scan);

  /// Removes from the scans since a time what lies where moving tracks were. Objects are known
  /// later than they are seen: who comes out of a door is in no box of the first frames.
  ///
  /// @param tracks  in the odometry frame, in which neither they nor the scans were corrected since
  void leaveOut(const std::vector<Track>& tracks, Time since);

  /// Adds the scans of another map in the same frame, as later ones.
  ///
  /// @param keyframe_shift  from ids of its keyframes to those of the common map
  void add(const DenseMap& other, std::int64_t keyframe_shift);

  /// Discards scans from places outside of a box, and points outside of it [m, map frame].
  void crop(const Eigen::AlignedBox3d& box);

  /// Updates the poses of the scans after a change of the keyframes; what they enter is fused when
  /// it is asked for.
  void follow(const SharedChunks<slam::KeyframeView>& keyframes);

  /// Whether scans have come or moved since the points were fused.
  [[nodiscard]] bool isOutdated() const { return !outdated_.empty(); }

  /// All points, after fusing what has changed. Null without scans.
  [[nodiscard]] mrpt::maps::CColouredPointsMap::Ptr layer();

  using Tiles = std::map<std::array<std::int32_t, 2>, std::shared_ptr<const DenseTile>>;
  /// Result of a fusion in another thread.
  struct Fused {
    Tiles tiles;
    mrpt::maps::CColouredPointsMap::Ptr layer;
  };
  /// The fusion of what has changed since the last one, for another thread: it holds copies of
  /// poses, and shares what never changes. apply() its result before the next one is started.
  [[nodiscard]] std::function<Fused()> fusion();
  void apply(Fused fused);

  /// All scans, for load(). The source may be used in another thread, at any later time.
  [[nodiscard]] ByteSource save() const;
  /// Restores the result of save(); the voxel may differ.
  /// @throws InputError if the bytes are invalid
  void load(const std::string& bytes);

  [[nodiscard]] std::size_t scans() const { return scans_.size(); }

 private:
  struct StoredScan {
    AnchoredPose pose;
    std::optional<Pose> T_odom_robot;  ///< unknown for scans that were loaded
    std::uint64_t order = 0;           ///< of its addition
    std::shared_ptr<const DepthScan> scan;
    Eigen::AlignedBox3d bounds;  ///< of its points, robot frame [m]
  };
  using TileIndex = Tiles::key_type;

  [[nodiscard]] DenseMap loaded(const std::string& bytes) const;
  [[nodiscard]] std::set<TileIndex> tilesOf(const StoredScan& stored) const;
  void replace(const AnchoredPose& pose, const std::optional<Pose>& T_odom_robot,
               std::shared_ptr<const DepthScan> scan);
  [[nodiscard]] std::vector<const StoredScan*> inOrder() const;
  void markOutdated(const StoredScan& stored);

  DenseMapParams params_;
  std::map<ScanPlace, StoredScan> scans_;
  std::uint64_t next_order_ = 0;
  AnchorPoses keyframes_;
  std::set<TileIndex> outdated_;
  Tiles tiles_;
};

/// Points of the dense map in a stored one, as DenseMap::save() left it.
///
/// @throws InputError if the bytes are invalid
[[nodiscard]] mrpt::maps::CColouredPointsMap::Ptr denseLayer(const std::string& bytes);

}  // namespace headway::map
