// SPDX-License-Identifier: BSD-3-Clause
// A depth scan seen from its camera: its surfaces, the depth in a direction, and parts of it.
#pragma once

#include <headway/core/scan.h>
#include <headway/core/track.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace headway::map {

inline constexpr float kMinDepth = 0.1F;     ///< of what a camera sees [m]
inline constexpr float kDepthSigmas = 3.0F;  ///< within which depths agree

/// A depth scan at a pose, unpacked to look up depths. Points are relative to the corner of a tile.
///
/// Between cells of one smooth surface, disparities are interpolated: those of a plane are linear
/// in the image, so that ground which is seen at a grazing angle has no gaps.
class ScanView {
 public:
  /// @param corner  of the tile in the map [m]
  ScanView(const DepthScan& scan, const Pose& T_map_robot, const Eigen::Vector2d& corner);

  /// @param use  called with the point of each cell [m], its colour (0 to 255) and the variance of
  ///             its depth
  template <typename Use>
  void forEachPoint(const Use& use) const {
    forEachCell([&](std::size_t cell, const Eigen::Vector3f& colour) {
      const float depth = depthOf(disparity_[cell]);
      use(pointAt(columnOf(cell), rowOf(cell), depth), colour, varianceOf(depth));
    });
  }

  /// The same of points at most `spacing` [m] apart, where the surface between cells is smooth.
  template <typename Use>
  void forEachSurfacePoint(float spacing, const Use& use) const {
    forEachCell([&](std::size_t cell, const Eigen::Vector3f& colour) {
      const auto steps = stepsBetween(cell, spacing);
      for (int i = 0; i < steps[1]; ++i) {
        for (int j = 0; j < steps[0]; ++j) {
          const float x = static_cast<float>(j) / static_cast<float>(steps[0]);
          const float y = static_cast<float>(i) / static_cast<float>(steps[1]);
          const float depth =
              depthOf(j + i == 0 ? static_cast<float>(disparity_[cell]) : disparityIn(cell, x, y));
          use(pointAt(columnOf(cell) + x, rowOf(cell) + y, depth), colour, varianceOf(depth));
        }
      }
    });
  }

  /// What the scan measured in the direction of a point.
  struct Look {
    float depth;     ///< of the point [m]
    float measured;  ///< in its cell [m]
    float variance;  ///< of the measured depth [m^2]
    std::size_t cell;
  };
  /// nullopt if the point is out of view or its cell unknown.
  [[nodiscard]] std::optional<Look> lookAt(const Eigen::Vector3f& point) const {
    const Eigen::Vector3f in_camera = R_tile_cam_.transpose() * (point - camera_);
    if (!(in_camera.z() > kMinDepth) || in_camera.z() > max_depth_) return std::nullopt;
    const float inverse = 1.0F / in_camera.z();
    const float column = (in_camera.x() * inverse - ray_first_.x()) * inverse_step_.x();
    const float row = (in_camera.y() * inverse - ray_first_.y()) * inverse_step_.y();
    if (!(column >= -0.5F && row >= -0.5F && column + 0.5F < static_cast<float>(columns_) &&
          row + 0.5F < static_cast<float>(rows_))) {
      return std::nullopt;
    }
    const std::size_t cell =
        static_cast<std::size_t>(row + 0.5F) * columns_ + static_cast<std::size_t>(column + 0.5F);
    if (disparity_[cell] == 0) return std::nullopt;
    const float measured = depthOf(disparityAt(cell, column, row));
    return Look{in_camera.z(), measured, varianceOf(measured), cell};
  }

  /// The least depth in the 3 x 3 cells around; 0 where one of them is unknown or missing.
  [[nodiscard]] float nearestRound(const Look& look) const;

  [[nodiscard]] const Eigen::Vector3f& cameraPosition() const { return camera_; }

 private:
  template <typename Use>
  void forEachCell(const Use& use) const {
    const std::size_t channels = scan_.hasColour() ? 3 : 1;
    std::size_t known = 0;
    for (std::size_t cell = 0; cell < disparity_.size(); ++cell) {
      if (disparity_[cell] == 0) continue;
      const auto* colour = &scan_.colour[channels * known++];
      use(cell, channels == 3 ? Eigen::Vector3f(colour[0], colour[1], colour[2])
                              : Eigen::Vector3f::Constant(static_cast<float>(colour[0])));
    }
  }

  [[nodiscard]] float columnOf(std::size_t cell) const {
    return static_cast<float>(cell % columns_);
  }
  [[nodiscard]] float rowOf(std::size_t cell) const { return static_cast<float>(cell / columns_); }
  [[nodiscard]] Eigen::Vector3f inCamera(float column, float row, float depth) const {
    return depth * Eigen::Vector3f(column * ray_step_.x() + ray_first_.x(),
                                   row * ray_step_.y() + ray_first_.y(), 1.0F);
  }
  [[nodiscard]] Eigen::Vector3f pointAt(float column, float row, float depth) const {
    return R_tile_cam_ * inCamera(column, row, depth) + camera_;
  }
  [[nodiscard]] float depthOf(float disparity) const { return focal_baseline_ / disparity; }
  [[nodiscard]] float varianceOf(float depth) const {
    const float sigma = sigma_factor_ * depth * depth;
    return sigma * sigma;
  }

  /// Disparity between a cell and those right of it and below, from 0 to 1 of the way.
  [[nodiscard]] float disparityIn(std::size_t cell, float x, float y) const {
    const auto at = [&](std::size_t of) { return static_cast<float>(disparity_[of]); };
    const float above = at(cell) + x * (at(cell + 1) - at(cell));
    const float below = at(cell + columns_) + x * (at(cell + columns_ + 1) - at(cell + columns_));
    return above + y * (below - above);
  }
  /// Disparity at a place in or beside a known cell.
  [[nodiscard]] float disparityAt(std::size_t cell, float column, float row) const {
    if (column >= 0.0F && row >= 0.0F) {
      const auto left = static_cast<std::size_t>(column);
      const auto above = static_cast<std::size_t>(row);
      const std::size_t corner = above * columns_ + left;
      if (is_smooth_[corner] != 0) {
        return disparityIn(corner, column - static_cast<float>(left),
                           row - static_cast<float>(above));
      }
    }
    return static_cast<float>(disparity_[cell]);
  }
  /// Steps from a cell to the one right of it and the one below; 1 where the surface ends.
  [[nodiscard]] std::array<int, 2> stepsBetween(std::size_t cell, float spacing) const;
  void markSmooth();

  const DepthScan& scan_;
  std::size_t columns_, rows_;
  std::vector<std::uint16_t> disparity_;  ///< of all cells, 0: unknown
  std::vector<std::uint8_t> is_smooth_;   ///< whether a cell, those right of it and below, and the
                                          ///< one between these are on one surface
  Eigen::Matrix3f R_tile_cam_;
  Eigen::Vector3f camera_;
  Eigen::Vector2f ray_first_, ray_step_, inverse_step_;
  float focal_baseline_;  ///< in units of the stored disparities
  float sigma_factor_;    ///< sigma of a depth by its square [1/m]
  float max_depth_ = 0.0F;
};

/// The points of a scan inside of a box of the map [m].
[[nodiscard]] DepthScan cropped(const DepthScan& scan, const Pose& T_map_robot,
                                const Eigen::AlignedBox3d& box);

/// Upright box of an object in the odometry frame, at some time.
struct UprightBox {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();    ///< length, width, height [m]
  double yaw = 0.0;                                  ///< [rad]
  double margin_m = 0.0;                             ///< by which the object may extend beyond it
};

/// What is assumed of a track before and around its observations.
struct PastBoxParams {
  double margin_m = 0.15;           ///< by which boxes and poses may be wrong [m]
  double max_back_s = 1.0;          ///< before the track was first seen [s]
  double first_velocity_s = 0.5;    ///< from its first point, by which its velocity is known [s]
  double velocity_error_mps = 0.3;  ///< by a change of velocity before that [m/s]
};

/// Box of a track at an earlier time, by its smoothed path, and before that by its first velocity,
/// but no farther back than it has been followed since, and as far as the parameters say.
///
/// @return  nullopt where its path is not known
[[nodiscard]] std::optional<UprightBox> pastBox(const Track& track, Time time,
                                                const PastBoxParams& params = {});

/// A scan without the cells in boxes of the same frame, which are enlarged by three standard
/// deviations of the depth.
///
/// @return  nullopt if no cell is in them
[[nodiscard]] std::optional<DepthScan> without(const DepthScan& scan, const Pose& T_odom_robot,
                                               const std::vector<UprightBox>& boxes);

}  // namespace headway::map
