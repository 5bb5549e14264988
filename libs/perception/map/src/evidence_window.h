// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <utility>

#include "evidence_grid.h"

namespace headway::map {

inline constexpr double kEvidenceUnit = 16.0;  ///< a unit of log-odds, as in MRPT's cells

/// Evidence of one scan for the cells around it.
class EvidenceGrid::Window {
 public:
  /// @param scan  must outlive the window
  Window(const GroundScan& scan, const Pose& T_map_robot, const RobotFootprint& footprint,
         double resolution);

  [[nodiscard]] bool isFinite() const { return bounds_.sizes().allFinite(); }
  /// Whether the cells can be counted.
  [[nodiscard]] bool fits() const;
  [[nodiscard]] Area area() const;
  /// Sets the evidence. The window must fit.
  void fill();

  std::vector<std::int8_t> evidence;  ///< row by row
  std::vector<std::int8_t> laser;     ///< empty without laser

 private:
  using Segment = std::pair<Eigen::Vector2d, Eigen::Vector2d>;

  std::vector<Segment> segments(const std::vector<GroundScan::Free>& pieces,
                                const Pose& T_map_robot);
  std::vector<Eigen::Vector2d> feet(const std::vector<GroundScan::Obstacle>& obstacles,
                                    const Pose& T_map_robot);
  /// Positions in every cell that the footprint meets; it is enlarged by half a cell for those that
  /// it only touches.
  [[nodiscard]] std::vector<Eigen::Vector2d> placesUnder(const RobotFootprint& footprint,
                                                         const Pose& T_map_robot) const;
  [[nodiscard]] int cellOf(double metres) const;
  /// Clamped, because positions between two ends may be rounded to a cell beyond them.
  [[nodiscard]] std::size_t at(const Eigen::Vector2d& place) const;
  void enterFree(const std::vector<Segment>& pieces, std::vector<std::int8_t>& cells) const;
  void hit(const Eigen::Vector2d& foot, const GroundScan::Obstacle& obstacle);

  double resolution_;
  const GroundScan& scan_;
  Eigen::AlignedBox2d bounds_;  ///< of all that follows [m]
  std::vector<Eigen::Vector2d> under_;
  std::vector<Segment> free_, passed_;
  std::vector<Eigen::Vector2d> obstacles_, laser_obstacles_;
  Area area_;
};

}  // namespace headway::map
