// SPDX-License-Identifier: BSD-3-Clause
// What is blocked and what is free around the robot now, by the newest frames.
#pragma once

#include <headway/core/params.h>
#include <headway/core/scan.h>
#include <headway/core/stereo_camera.h>
#include <headway/map/static_grid.h>

#include <optional>
#include <vector>

namespace headway::map {

constexpr double kCaution = 0.5;  ///< of a robot about what is out of its view, unless it is told
constexpr double kLocalHold_s = 6.0;  ///< that it counts, with caution 1: who walks passes 9 m

/// What the newest frames say about a place on the ground.
enum class LocalState {
  kBlocked,    ///< something stands there
  kFree,       ///< it was seen to be free, and nothing was seen to enter it since
  kUnknown,    ///< it is in view and not seen
  kEntered,    ///< something was seen to leave the view that may be there
  kNotInView,  ///< nothing is known about it that is newer than the map
};

/// Obstacles and free ground of the last second, from every frame, in the odometry frame.
///
/// Independent of detectors, tracks, classes and of the map. Each cell sums the evidence of what
/// hits it and of what passes it, by columns of the disparity image and beams of lasers, as a
/// logarithm of odds that decays: in view within 0.5 s, so that only what is seen again stays free
/// or blocked; out of view (nearer than the nearest visible ground or than what is measured, beside
/// and behind the robot) within a time that the asker's caution chooses, three times that where
/// something had been standing for two seconds. What is hit in two frames,
/// within what a person walks between them, is blocked at once. What enters a place out of view was
/// seen at the edge of the view, where it was free before: ground is unknown where it is if it
/// walks on, as far around as people turn, and on its way, where it may have stopped, until it is
/// seen again or that time has passed.
///
/// Stereo and depth cameras make ground free, lasers never do (see GroundScan). The strip between
/// the robot and the nearest visible ground, up to 1.5 times the camera's height, counts as seen
/// with that ground, which people in it would hide, unless something stands in it that the ray to
/// that ground passes over or under.
///
/// @see  Thrun, Burgard & Fox 2005, "Probabilistic Robotics", ch. 9 (occupancy by log odds)
class LocalLayer {
 public:
  /// @param reach_m    of the scans; the layer ends there, at 3 m at least [m]
  /// @param nearest_m  depth from which the camera measures [m]
  explicit LocalLayer(double reach_m = 0.0, const RobotFootprint& footprint = {},
                      double nearest_m = 0.0);

  /// Takes a frame.
  ///
  /// @param time    before the last one: the clock was set back, and all is forgotten [s]
  /// @param scan    with all that moves; empty if nothing was seen
  /// @param camera  that saw it; nullopt: lasers alone
  /// @param step    from one scanned column of the disparity image to the next, 1 or 2
  void add(Time time, const Pose& T_odom_robot, const GroundScan& scan,
           const std::optional<StereoCamera>& camera, int step = 1);

  /// @param place    odometry frame [m]
  /// @param caution  0 to 1: how long (6 s with 1) and how far (at 1.5 m/s with 1) what is out of
  ///                 view counts
  /// @param within_s kEntered, too, where what left the view may be by then [s]
  [[nodiscard]] LocalState at(const Eigen::Vector2d& place, Time now, double caution,
                              double within_s = 0.0) const;

  /// Whether a place is free because it was seen to be, after a time.
  [[nodiscard]] bool wasSeenFree(const Eigen::Vector2d& place, Time since, Time now,
                                 double caution) const;

  /// Centres of all blocked cells, odometry frame [m].
  [[nodiscard]] std::vector<Eigen::Vector2d> blocked(Time now, double caution) const;

  [[nodiscard]] double cell_m() const { return cell_m_; }
  [[nodiscard]] double reach_m() const { return reach_m_; }

 private:
  /// Between which something is hit; 0: unknown [m].
  struct Heights {
    float low = 0.0F, high = 0.0F;

    void include(const Heights& other);
  };
  struct Cell {
    int x = 0, y = 0;  ///< which of the cells with this index modulo the layer's size
    float odds = 0.0F;
    float seen_s = 0.0F;                                  ///< time of the odds, since the start
    float free_s = -1.0e9F;                               ///< time at which it was last free
    float hit_s = -1.0e9F;                                ///< and last hit
    Heights heights = {};                                 ///< at which something was hit
    float struck_s = -1.0e9F, struck_before_s = -1.0e9F;  ///< last times of many hits
  };
  /// What came where ground had been free.
  struct Intruder {
    Eigen::Vector2d place;
    Time time = 0.0;
    Eigen::Vector2d velocity = Eigen::Vector2d::Zero();  ///< [m/s]
    double spread_mps = 0.0;                             ///< by which it may move otherwise

    [[nodiscard]] bool isWithin(double seconds, const Eigen::Vector2d& at, double caution) const;
  };
  struct Evidence {
    float hits = 0.0F;
    float passes = 0.0F;
    Heights heights = {};  ///< of what is hit
  };
  class Frame;

  [[nodiscard]] std::size_t indexOf(int x, int y) const;
  [[nodiscard]] const Cell* find(const Eigen::Vector2d& place) const;
  [[nodiscard]] Eigen::Vector2d centreOf(const Cell& cell) const {
    return cell_m_ * Eigen::Vector2d(cell.x + 0.5, cell.y + 0.5);
  }
  [[nodiscard]] bool isInView(const Eigen::Vector2d& place) const;
  [[nodiscard]] bool isGap(const Eigen::Vector2d& place, Time now) const;
  [[nodiscard]] bool wasStruckNear(const Cell& cell, float before_s) const;
  [[nodiscard]] bool isAtStanding(const Eigen::Vector2d& place) const;
  [[nodiscard]] bool isAtEdgeOfView(const Eigen::Vector2d& place) const;
  [[nodiscard]] double oddsOf(const Cell& cell, bool in_view, Time now, double hold_s) const;
  [[nodiscard]] bool mayBeEntered(const Eigen::Vector2d& place, float since_s, Time now,
                                  double caution) const;
  [[nodiscard]] bool mayCome(const Eigen::Vector2d& place, Time now, double within_s,
                             double caution) const;
  [[nodiscard]] Eigen::Vector2d nearestOfRobot(const Eigen::Vector3f& point) const;
  [[nodiscard]] bool wouldHide(const Cell& cell, const Eigen::Vector2d& ground) const;
  void addStrip(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Frame& frame) const;
  void enter(const Frame& frame, Time time, double weight);
  void measureVelocity(const std::vector<Intruder>& come, Intruder& one) const;
  void dropSeenAgain(const Eigen::Vector2d& place, Time time);
  void standAt(const Pose& T_odom_robot);

  double reach_m_;
  double nearest_m_;
  double cell_m_;
  int size_;  ///< cells along a side
  RobotFootprint footprint_;
  std::vector<Cell> cells_;
  std::vector<Intruder> intruders_;  ///< seen where the view ends
  std::vector<Intruder> come_;       ///< all of the last half second
  std::optional<StereoCamera> camera_;
  Pose T_odom_robot_ = Pose::Identity();
  Pose T_cam_odom_ = Pose::Identity();
  double ground_z_ = 0.0;  ///< odometry frame, under the robot [m]
  Time start_ = 0.0;
  Time time_ = 0.0;  ///< of the last frame
  bool is_started_ = false;
};

}  // namespace headway::map
