// SPDX-License-Identifier: BSD-3-Clause
// The off-screen drawing of a scene by two cameras.
#pragma once

#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <memory>
#include <opencv2/core/mat.hpp>
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

/// One drawn stereo pair, before anything that a sensor does to it.
struct StereoDrawing {
  cv::Mat left;   ///< 8-bit BGR
  cv::Mat right;  ///< 8-bit BGR
  cv::Mat depth;  ///< 32-bit, metres along the left camera's axis; 0 where there is only sky
};

/// Draws a world and its actors as an ideal stereo camera sees them, off-screen.
///
/// Made and used in one thread. Everything is drawn relative to the robot, so pictures are as
/// sharp far from the world's origin as near it.
class StereoRig {
 public:
  /// @param camera  geometry of both drawn cameras; any width
  StereoRig(const StereoCamera& camera, std::unique_ptr<Scene> scene);
  ~StereoRig();
  StereoRig(const StereoRig&) = delete;
  StereoRig& operator=(const StereoRig&) = delete;

  /// @param T_left_right  right optical frame in the left one
  /// @param actors        those in view, with the parked ones
  /// @param meshes        their meshes, relative to the robot's position
  /// @param with_depth    fill `depth`, too
  [[nodiscard]] StereoDrawing draw(const Pose& T_world_robot, const Pose& T_left_right,
                                   const std::vector<Actor>& actors,
                                   const std::vector<Mesh>& meshes, bool with_depth);

 private:
  class Renderer;
  std::unique_ptr<Renderer> renderer_;
};

}  // namespace headway::sim
