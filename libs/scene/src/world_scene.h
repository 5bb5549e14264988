#pragma once

#include <headway/scene/snapshot.h>
#include <mrpt/opengl/COpenGLScene.h>

#include "landmark_clouds.h"

namespace headway::scene {

/// What the 3D scene is built for.
enum class SceneUse {
  kFile,     ///< everything is in it
  kPicture,  ///< outlines and labels are left out: they are drawn crisper over the picture
};

/// The map as a 3D scene; landmarks are built again only when the map has others.
class WorldScene {
 public:
  /// @param point_size  of landmarks in the drawn picture [px]
  WorldScene(SceneUse use, float point_size) : use_(use), point_size_(point_size) {}

  /// Objects by name: `ground_grid`, `landmarks`, `true_path`, `camera_path`, `robot`,
  /// `moving_objects`, and in a file `true_objects`, `camera`.
  ///
  /// @param view  what a picture will show: landmarks outside are left out; nullptr: all are in
  [[nodiscard]] mrpt::opengl::COpenGLScene build(const SnapshotInput& input, double ground_z,
                                                 const render::PinholeView* view = nullptr);

 private:
  SceneUse use_;
  float point_size_;
  LandmarkClouds landmarks_;
};

}  // namespace headway::scene
