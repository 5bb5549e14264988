// SPDX-License-Identifier: BSD-3-Clause
// The occupancy grid as the sum of ground scans, of which one a place and direction is stored.
#pragma once

#include <headway/core/params.h>
#include <headway/core/scan.h>
#include <headway/map/anchored_pose.h>
#include <headway/slam/map_view.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace headway::map {

class EvidenceGrid;

/// Ground that the robot covers, a rectangle about its origin. Section [robot].
struct RobotFootprint {
  double length_m = 0.0;  ///< 0: no ground is known by the robot's presence [m]
  double width_m = 0.0;   ///< [m]

  [[nodiscard]] bool empty() const { return length_m <= 0.0 || width_m <= 0.0; }
  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "robot"); }  ///< @throws InputError
};

/// Parameters of the occupancy grid. Part of section [grid].
struct StaticGridParams {
  double resolution_m = 0.2;  ///< side of a cell [m]
  double spacing_m = 0.0;     ///< between the places whose scans are stored; 0: 1 m [m]
  RobotFootprint footprint;   ///< free wherever the robot was; not a key of [grid]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "grid"); }  ///< @throws InputError
};

/// Occupancy grid of free ground and obstacles: the sum of ground scans.
///
/// The last scan of each place and direction is stored, so that memory grows with the area and not
/// with time, and an obstacle that has left disappears when its place is scanned again. Scans are
/// attached to the nearest keyframe: the grid follows every correction of the map. It depends on
/// scans and poses only, not on their order. Above 20 million cells the resolution is reduced.
///
///     StaticGrid grid(params);
///     grid.follow(slam.map().keyframes);    // after each keyframe
///     grid.add(T_map_robot, scan);          // of frames, as often as wanted
///     map.update(grid.grid());
class StaticGrid {
 public:
  explicit StaticGrid(const StaticGridParams& params);
  ~StaticGrid();
  StaticGrid(StaticGrid&&) noexcept;
  StaticGrid& operator=(StaticGrid&&) noexcept;

  /// Adds a scan in place of the last one from the same place and direction; one without stereo
  /// does not replace one with it, because a laser passes over low obstacles. The ground that the
  /// robot drove over since the previous scan is free if the two are less than 5 m apart.
  ///
  /// @param T_odom_robot  by which the way since the previous scan is known, whatever the map does
  void add(const Pose& T_map_robot, const Pose& T_odom_robot, GroundScan scan);
  /// The same where the map does not move.
  void add(const Pose& T_map_robot, GroundScan scan) {
    add(T_map_robot, T_map_robot, std::move(scan));
  }
  /// The camera is lost: the way to the next scan is not known.
  void interrupt() { last_.reset(), before_.reset(); }

  /// Adds the scans of another grid, whose keyframes have ids greater by `keyframe_shift` in the
  /// map of this one. Of two scans from the same place and direction the other grid's remains.
  void add(const StaticGrid& other, std::int64_t keyframe_shift);

  /// Removes the scans from outside of a rectangle, and of the others what lies outside.
  void crop(const Eigen::AlignedBox2d& area);

  /// Enters the footprint at the newest pose, in place of the one before.
  void standAt(const Pose& T_map_robot);

  /// Updates the poses of the scans after a change of the keyframes.
  void follow(const SharedChunks<slam::KeyframeView>& keyframes);

  /// The same in parts, so that a correction of the whole map delays no frame: moves `max_scans`,
  /// those of the newest keyframes first. followMore() moves the next ones.
  void follow(const SharedChunks<slam::KeyframeView>& keyframes, std::size_t max_scans);
  void followMore(std::size_t max_scans);

  /// The grid as an MRPT map; unobserved cells are 0.5. Null without observations.
  [[nodiscard]] mrpt::maps::COccupancyGridMap2D::Ptr grid() const;

  /// All scans, for load().
  [[nodiscard]] std::string save() const;
  /// Restores the result of save(); the resolution may differ.
  /// @throws InputError if the bytes are invalid
  void load(const std::string& bytes);

 private:
  using Place = ScanPlace;
  struct StoredScan {
    AnchoredPose pose;
    GroundScan scan;
  };

  [[nodiscard]] StaticGrid loaded(const std::string& bytes) const;
  /// Stores and enters a scan in place of the one from the same place and direction.
  void replace(const Place& place, StoredScan stored);
  void enter(const StoredScan& stored);
  /// Enters all scans in a new grid; false if it has too many cells of that size.
  [[nodiscard]] bool enterAll(double resolution_m);
  /// Pose by the anchor's present pose; nullopt if it has hardly changed.
  [[nodiscard]] std::optional<Pose> movedPose(StoredScan& stored) const;
  void move(StoredScan& stored, const Pose& T_map_robot);

  StaticGridParams params_;
  double resolution_m_;  ///< may be coarser than the parameter, see above
  std::unique_ptr<EvidenceGrid> evidence_;
  std::map<Place, StoredScan> scans_;
  Eigen::AlignedBox2d places_;  ///< bounds of their positions [m]
  AnchorPoses keyframes_;
  std::vector<Place> to_move_;  ///< places whose scans are to be moved, the next one last
  struct Passed {
    Place place;
    Pose T_odom_robot;
  };
  std::optional<Passed> last_;    ///< the last scan
  std::optional<Pose> standing_;  ///< argument of the last standAt()
  std::optional<Pose> before_;    ///< the last pose at another place, in odometry
};

}  // namespace headway::map
