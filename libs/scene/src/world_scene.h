// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/render/pinhole_view.h>
#include <headway/scene/snapshot.h>
#include <headway/slam/map_view.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <array>
#include <map>
#include <memory>
#include <utility>

namespace mrpt::opengl {
class CPointCloudColoured;
class CSetOfObjects;
}  // namespace mrpt::opengl

namespace headway::scene {

/// Drawing order of the objects in a 3D scene.
enum class DrawOrder { kOccupancy, kGrid, kLandmarks, kTruth, kPath, kRobot, kMovingObjects };

/// Sets the drawing order of an object. MRPT draws from far to near by one representative point
/// per object; these points are placed far below the scene, so that flat and translucent objects
/// are always drawn after the objects below them.
///
/// @param offset  position within the objects of the same order
void setDrawOrder(DrawOrder order, mrpt::opengl::CRenderizable& object, int offset = 0);

/// Width of a landmark's dot: 2.6 points, and no less in pixels, so that it can be seen [px].
[[nodiscard]] double landmarkWidth(const cv::Size& picture);

/// Landmarks as coloured points in square cells, so that a picture draws only the visible cells and
/// no more points than it can resolve: drawing takes about 0.4 us per point.
class LandmarkClouds {
 public:
  /// Builds the points of a static map unless they are up to date.
  void update(const std::shared_ptr<const slam::MapView>& static_map, double ground_z, double scale,
              float point_size);

  /// Inserts all points.
  void insertAll(mrpt::opengl::CSetOfObjects& out) const;

  /// Inserts the points of the visible cells, subsampled where they would overlap in the picture.
  void insertVisible(const render::PinholeView& view, mrpt::opengl::CSetOfObjects& out) const;

 private:
  struct Cell {
    Eigen::AlignedBox3d bounds;
    /// All points, every third point, every ninth point ...
    std::array<std::shared_ptr<mrpt::opengl::CPointCloudColoured>, 4> levels;
  };

  std::shared_ptr<const slam::MapView> current_map_;
  std::map<std::pair<int, int>, Cell> cells_;
};

/// Purpose of a 3D scene.
enum class SceneUse {
  kFile,     ///< contains everything
  kPicture,  ///< without outlines and labels, which are drawn on the picture in higher quality
};

/// Builds the map as a 3D scene; landmarks are rebuilt only when the static map changes.
class WorldScene {
 public:
  /// @param point_size  of landmarks in the rendered picture [px]
  WorldScene(SceneUse use, float point_size) : use_(use), point_size_(point_size) {}

  /// Object names: `occupancy`, `ground_grid`, `landmarks`, `true_path`, `camera_path`, `robot`,
  /// `moving_objects`, and in a file `dense`, `true_objects`, `camera`.
  ///
  /// @param view  of the picture, to omit landmarks outside it; nullptr: all landmarks
  [[nodiscard]] mrpt::opengl::COpenGLScene build(const SnapshotInput& input, double ground_z,
                                                 const render::PinholeView* view = nullptr);

 private:
  SceneUse use_;
  float point_size_;
  LandmarkClouds landmarks_;
};

}  // namespace headway::scene
