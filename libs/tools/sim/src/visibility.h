// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>

#include <opencv2/core/mat.hpp>
#include <vector>

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// What the left image shows of one actor.
struct Observation {
  std::size_t actor = 0;    ///< index in the actors given
  Box2d whole;              ///< around its whole drawn mesh, uncut [px]
  Box2d box;                ///< the same, cut at the image's edges [px]
  double truncation = 0.0;  ///< ratio of the uncut box outside the image
  double visible = 0.0;     ///< ratio of its pixels inside the image that nothing hides
  int visible_pixels = 0;
  Box3d box3d;  ///< in the left camera's optical frame
};

/// Finds which pixels of a drawn picture belong to which actor.
///
/// Meshes are drawn a second time, into a depth image of each one alone, and compared with the
/// picture's depth: a pixel is visible where the two agree.
///
/// @param meshes         the actors' meshes, relative to the robot's position
/// @param depth          of the left picture [m]
/// @param instances      set to 16-bit actor index + 1 per pixel, 0 elsewhere
/// @return               actors in front of the camera that reach into the image
[[nodiscard]] std::vector<Observation> observeActors(const Pose& T_world_robot,
                                                     const StereoCamera& camera,
                                                     const std::vector<Actor>& actors,
                                                     const std::vector<Mesh>& meshes,
                                                     const cv::Mat& depth, cv::Mat& instances);

/// The actor's truth box in the left camera's optical frame.
[[nodiscard]] Box3d opticalBox(const Actor& actor, const Pose& T_world_cam);

}  // namespace headway::sim
