#pragma once

#include <headway/core/ground_scan.h>
#include <headway/core/params.h>
#include <headway/slam/map_view.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::map {

class EvidenceGrid;

/// How looks over the ground become a grid of free and occupied cells. Part of section [grid].
struct StaticGridParams {
  double resolution_m = 0.2;  ///< side of a cell [m]
  double spacing_m = 1.0;     ///< of the places whose looks are kept [m]

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "grid"); }  ///< @throws InputError
};

/// Where one can drive: the sum of all looks over the ground.
///
/// Of each place and direction the last look is kept, so that what is kept grows with the area and
/// not with time, and what has gone disappears when it is looked at again. Looks hang on the
/// nearest keyframe: the grid follows every correction of the map. It depends on the looks and
/// poses alone, not on how it came to them. Beyond 25 million cells it gets coarser.
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

  /// Takes in what was seen from a place. The ground that the robot drove over since the look
  /// before is free, if that was less than 5 m away.
  void add(const Pose& T_map_robot, GroundScan scan);

  /// Moves what was seen along with the keyframes.
  void follow(const std::vector<slam::KeyframeView>& keyframes);

  /// The grid as MRPT knows it; cells that nobody saw are 0.5. Null while nothing was seen.
  [[nodiscard]] mrpt::maps::COccupancyGridMap2D::Ptr grid() const;

  /// All looks, to go on from later.
  [[nodiscard]] std::string save() const;
  /// Goes on from what save() gave; the resolution may be another.
  /// @throws InputError if the bytes are not that
  void load(const std::string& bytes);

 private:
  /// Place and direction in steps: x, y and heading.
  using Place = std::array<std::int32_t, 3>;
  struct Look {
    Pose T_map_robot;
    KeyframeId anchor;  ///< not valid where there are no keyframes
    Pose T_anchor_robot = Pose::Identity();
    GroundScan scan;
  };

  [[nodiscard]] Place placeOf(const Pose& T_map_robot) const;
  void enter(const Look& look);
  void hangOnNearest(Look& look) const;

  StaticGridParams params_;
  double resolution_m_;  ///< coarser than asked for where the map is vast
  std::unique_ptr<EvidenceGrid> evidence_;
  std::map<Place, Look> looks_;
  Eigen::AlignedBox2d places_;  ///< bounds of where they were taken [m]
  std::map<KeyframeId, Pose> keyframes_;
  struct Passed {
    Place place;
    Pose T_map_robot;
  };
  std::optional<Passed> last_;  ///< where the robot looked last
  std::optional<Pose> before_;  ///< the last pose at another place than that
};

/// Writes `<prefix>.gridmap.gz` (MRPT), and `<prefix>.png` with `<prefix>.yaml` (map servers).
///
/// @throws InputError if a file cannot be written
void writeStaticGrid(const std::string& prefix, const mrpt::maps::COccupancyGridMap2D& grid);

}  // namespace headway::map
