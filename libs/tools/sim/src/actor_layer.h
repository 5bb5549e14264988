// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/opengl/COpenGLScene.h>

#include <functional>
#include <vector>

#include "actor.h"
#include "grain.h"
#include "textured_object.h"

namespace headway::sim {

/// The drawn objects of all actors: vehicles, people, and the shadows below them.
class ActorLayer {
 public:
  /// Adds its objects to the scene.
  ActorLayer(mrpt::opengl::COpenGLScene& scene, const Grain& grain, Random& random);

  /// Draws each shadow a hair above the one before, so that people who stand close together have
  /// shadows that do not show through each other.
  void stackShadows() { shadow_step_m_ = 1e-4; }

  /// @param meshes  of the actors, relative to the origin
  /// @param shows   whether a mesh may be seen
  void show(const std::vector<Actor>& actors, const std::vector<Mesh>& meshes,
            const Eigen::Vector3d& origin, const std::function<bool(const Mesh&)>& shows);
  /// Opaque actors are drawn first, shadows last.
  void place(const Eigen::Vector3d& forward);

 private:
  TexturedObject::Ptr vehicles_, people_, shadows_;
  double shadow_step_m_ = 0.0;
};

}  // namespace headway::sim
