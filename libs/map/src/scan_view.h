// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/depth_scan.h>

#include <Eigen/Geometry>
#include <cmath>
#include <optional>
#include <vector>

namespace headway::map {

/// A depth scan at a pose, unpacked to look up depths. Points are relative to the corner of a tile.
class ScanView {
 public:
  /// @param corner  of the tile in the map [m]
  ScanView(const DepthScan& scan, const Pose& T_map_robot, const Eigen::Vector2d& corner);

  /// @param use  called with each point [m], its colour (0 to 255) and the variance of its depth
  template <typename Use>
  void forEachPoint(const Use& use) const {
    std::size_t known = 0;
    const std::size_t channels = scan_.hasColour() ? 3 : 1;
    for (std::size_t cell = 0; cell < disparity_.size(); ++cell) {
      if (disparity_[cell] == 0) continue;
      const auto column = static_cast<float>(cell % columns_);
      const auto row = static_cast<float>(cell / columns_);
      const float depth = depthOf(disparity_[cell]);
      const Eigen::Vector3f ray(column * ray_step_.x() + ray_first_.x(),
                                row * ray_step_.y() + ray_first_.y(), 1.0F);
      const auto* colour = &scan_.colour[channels * known++];
      const Eigen::Vector3f rgb = channels == 3
                                      ? Eigen::Vector3f(colour[0], colour[1], colour[2])
                                      : Eigen::Vector3f::Constant(static_cast<float>(colour[0]));
      use(Eigen::Vector3f(R_tile_cam_ * (depth * ray) + camera_), rgb, varianceOf(depth));
    }
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
    const float column = (in_camera.x() * inverse - ray_first_.x()) * inverse_step_.x() + 0.5F;
    const float row = (in_camera.y() * inverse - ray_first_.y()) * inverse_step_.y() + 0.5F;
    if (!(column >= 0.0F && row >= 0.0F && column < static_cast<float>(columns_) &&
          row < static_cast<float>(rows_))) {
      return std::nullopt;
    }
    const std::size_t cell =
        static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column);
    if (disparity_[cell] == 0) return std::nullopt;
    const float measured = depthOf(disparity_[cell]);
    return Look{in_camera.z(), measured, varianceOf(measured), cell};
  }

  /// The least depth in the 3 x 3 cells around; 0 where one of them is unknown or missing.
  [[nodiscard]] float nearestRound(const Look& look) const;

  [[nodiscard]] const Eigen::Vector3f& cameraPosition() const { return camera_; }

 private:
  static constexpr float kMinDepth = 0.1F;

  [[nodiscard]] float depthOf(std::uint16_t disparity) const {
    return focal_baseline_ / static_cast<float>(disparity);
  }
  [[nodiscard]] float varianceOf(float depth) const {
    const float sigma = sigma_factor_ * depth * depth;
    return sigma * sigma;
  }

  const DepthScan& scan_;
  std::size_t columns_, rows_;
  std::vector<std::uint16_t> disparity_;  ///< of all cells, 0: unknown
  Eigen::Matrix3f R_tile_cam_;
  Eigen::Vector3f camera_;
  Eigen::Vector2f ray_first_, ray_step_, inverse_step_;
  float focal_baseline_;  ///< in units of the stored disparities
  float sigma_factor_;    ///< sigma of a depth by its square [1/m]
  float max_depth_ = 0.0F;
};

}  // namespace headway::map
