// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "site.h"

namespace headway::sim {

/// A piece of a wall that is missing between two heights: a door, a window.
struct Opening {
  double at_m = 0.0;  ///< its middle, along the wall
  double width_m = 1.0;
  double bottom_m = 0.0;
  double top_m = 2.1;
};

/// An upright box standing at `base_m`, turned by yaw.
struct BoxShape {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< world [m]
  double yaw = 0.0;                                  ///< [rad]
  Eigen::Vector3d size = Eigen::Vector3d::Ones();    ///< along yaw, across, up [m]
  double base_m = 0.0;
};

/// Puts boxes, walls and floors into a site: their surfaces, and what they block.
class SiteBuilder {
 public:
  explicit SiteBuilder(Site& site) : site_(site) {}

  /// A box, impassable if it reaches into the room that people and robots take.
  void box(const BoxShape& shape, Material material);
  /// The same without blocking anybody: lamps, posters, paint, what stands on furniture.
  void ornament(const BoxShape& shape, Material material);
  /// A box in coordinates of a piece of furniture: `at` is its middle, x along yaw.
  void part(const Spot& origin, const Eigen::Vector2d& at, const Eigen::Vector3d& size,
            double base_m, Material material);

  /// Level ground over a rectangle, with rectangular holes.
  void floor(const Eigen::AlignedBox2d& area, double height_m, Material material,
             const std::vector<Eigen::AlignedBox2d>& holes = {});
  /// Ground that is not at height 0: recorded, and drawn with its outline convex and clockwise from
  /// above.
  void slope(const std::vector<Eigen::Vector3d>& outline, Material material);
  /// The underside of a ceiling.
  void ceiling(const Eigen::AlignedBox2d& area, double height_m, Material material);
  /// A wall around openings, with skirting boards and window frames.
  void wall(const Eigen::Vector2d& from, const Eigen::Vector2d& to, double height_m,
            Material material, const std::vector<Opening>& openings = {});
  /// An impassable pit, recorded as a drop, with walls and a bottom.
  void pit(const Eigen::AlignedBox2d& area, double depth_m, Material material);
  /// Steps down into a pit along +x or -x; the pit's floor is not theirs.
  void stairsDown(const Eigen::AlignedBox2d& area, double depth_m, bool towards_positive_x,
                  Material material);
  /// Posts and bars between two points.
  void railing(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Material material);
  /// A strip that wheels bump over.
  void threshold(const Eigen::Vector2d& centre, double yaw, double length_m, double height_m);
  void block(const Footprint& footprint) { site_.obstacles.push_back(footprint); }

  /// An impassable edge at which nothing stands on the floor.
  void barEdge(const Footprint& footprint) { site_.edges.push_back(footprint); }
  [[nodiscard]] Site& site() { return site_; }

 private:
  void wallPart(const Eigen::Vector2d& from, const Eigen::Vector2d& along, double begin, double end,
                double bottom, double top, Material material);
  void quad(const std::array<Eigen::Vector3d, 4>& corners, const Eigen::Vector3d& right,
            const Eigen::Vector3d& down, Material material);

  Site& site_;
};

/// The rectangle between two corners.
[[nodiscard]] Eigen::AlignedBox2d rectangle(double x0, double y0, double x1, double y1);

}  // namespace headway::sim
