// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/render/painter.h>
#include <headway/scene/snapshot.h>

#include <memory>

#include "palette.h"
#include "point_cells.h"

namespace headway::scene {

/// Draws the map without outlines and text: sky and ground, occupancy, grid, points, paths, robot
/// and the moving objects' faces, trails and predictions. Points are prepared when they change.
class MapPicture {
 public:
  explicit MapPicture(const SnapshotOptions& options);

  /// @param view      external view of the options' size
  /// @param ground_z  height of the ground [m, map frame]
  [[nodiscard]] cv::Mat draw(const SnapshotInput& input, const render::PinholeView& view,
                             double ground_z);

  /// Whether points of the last picture hide a place of the map.
  [[nodiscard]] bool hides(const Eigen::Vector3d& place_map) const {
    return painter_.hides(place_map, margin_m_);
  }

 private:
  void updateLandmarks(const SnapshotInput& input, double ground_z);
  void updateDense(const SnapshotInput& input);
  void paintGround(const SnapshotInput& input, const render::PinholeView& view, double ground_z);
  void paintPoints(const SnapshotInput& input, const render::PinholeView& view);

  SnapshotOptions options_;
  const Palette& palette_;
  render::Painter painter_;
  double margin_m_ = 0.0;  ///< by which points must be nearer to hide something
  std::shared_ptr<const slam::MapView> static_map_;  ///< of landmarks_
  PointCells landmarks_;
  mrpt::maps::CColouredPointsMap::ConstPtr dense_map_;  ///< of dense_
  PointCells dense_;
  double dense_width_m_ = 0.0;
};

}  // namespace headway::scene
