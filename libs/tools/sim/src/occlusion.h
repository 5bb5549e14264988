// SPDX-License-Identifier: BSD-3-Clause
// What houses hide.
#pragma once

#include <headway/core/stereo_camera.h>

#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace headway::sim {

/// The eight corners of a house's walls: four below, the four above them in the same order [m].
using Block = std::array<Eigen::Vector3f, 8>;

/// What blocks of masonry hide from one camera.
///
/// Each column of pixels stores from which row to which row a block fills it, and how far the
/// block reaches. Errs on the side of what is seen: what it calls hidden shows in no pixel.
///
///     Occlusion occlusion(camera, T_cam_origin);
///     for (const Block& house : near_first) occlusion.add(house, offset);
///     if (!occlusion.hides(mesh_points, offset)) draw(...);
class Occlusion {
 public:
  /// @param camera  without distortion
  Occlusion(const StereoCamera& camera, const Eigen::Isometry3d& T_cam_origin);

  /// Adds a solid, convex block; near ones first make for less work.
  ///
  /// @param offset  of the block's frame in the origin's [m]
  void add(const Block& block, const Eigen::Vector3d& offset);

  /// Whether something inside the convex hull of the points shows in no pixel: behind blocks, or
  /// beside the image.
  [[nodiscard]] bool hides(const std::vector<Eigen::Vector3f>& points,
                           const Eigen::Vector3d& offset) const;

 private:
  struct Filled {
    float top, bottom;  ///< rows [px]
    float depth;        ///< of the block's farthest corner [m]
  };

  [[nodiscard]] Eigen::Isometry3f place(const Eigen::Vector3d& offset) const;
  [[nodiscard]] bool fills(int column, float top, float bottom, float depth) const;

  StereoCamera camera_;
  Eigen::Isometry3d T_cam_origin_;
  std::vector<std::vector<Filled>> columns_;
};

}  // namespace headway::sim
