// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "actor.h"
#include "mesh.h"
#include "scene.h"

namespace headway::sim {

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
