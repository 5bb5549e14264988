// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <vector>

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// Nothing farther is drawn [m].
inline constexpr float kFarPlane = 320.0F;

/// Radius of the drum that carries the sky's picture [m].
inline constexpr float kSkyRadius = 300.0F;

/// MRPT's scene of an environment and its actors, arranged anew for each frame.
class Scene {
 public:
  virtual ~Scene() = default;

  /// Puts into the scene what either camera may see, relative to the robot's position.
  ///
  /// @param meshes  the actors' meshes, relative to the robot's position
  virtual void arrange(const Pose& T_world_robot, const Pose& T_left_right,
                       const std::vector<Actor>& actors, const std::vector<Mesh>& meshes) = 0;

  [[nodiscard]] mrpt::opengl::COpenGLScene& scene() { return scene_; }
  /// The robot in the frame that the scene is arranged in.
  [[nodiscard]] const Pose& T_origin_robot() const { return T_origin_robot_; }

 protected:
  mrpt::opengl::COpenGLScene scene_;
  Pose T_origin_robot_ = Pose::Identity();
};

}  // namespace headway::sim
