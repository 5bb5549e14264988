// SPDX-License-Identifier: BSD-3-Clause
// Meshes in the image: their pixels, how much of it they cover, how much of them is visible.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>

#include <array>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "actor.h"
#include "mesh.h"

namespace headway::sim {

/// A triangle in the image: (u, v) [px] and inverse depth [1/m], which is linear over the image.
using ImageTriangle = std::array<Eigen::Vector3f, 3>;

/// Where nearer things begin not to be drawn [m].
inline constexpr float kNearPlane = 0.3F;

/// The mesh's triangles as the left camera sees them, cut at the near plane.
[[nodiscard]] std::vector<ImageTriangle> projectMesh(const Mesh& mesh,
                                                     const Eigen::Isometry3f& T_cam_mesh,
                                                     const StereoCamera& camera);

/// What meshes look like each alone, as depth pictures.
///
/// One buffer serves one mesh after another, so that nothing is allocated for each.
class MeshDepth {
 public:
  static constexpr float kNothing = std::numeric_limits<float>::max();

  /// @param image  size of the pictures that the meshes are projected into
  explicit MeshDepth(const cv::Size& image) : buffer_(image, CV_32F) {}

  /// @param area  part of the image to draw, inside of it
  /// @return      32-bit, the area's size: depth of the mesh's front [m], kNothing beside the mesh;
  ///              valid until the next drawing
  [[nodiscard]] const cv::Mat& draw(const std::vector<ImageTriangle>& mesh, const cv::Rect& area);

 private:
  void drawTriangle(const ImageTriangle& corners, const cv::Rect& area);

  cv::Mat buffer_;
  cv::Mat picture_;  ///< the buffer's part for the mesh that is drawn
};

/// Ratio of the left image that the meshes cover, as if nothing static stood before them.
///
/// Found without drawing, so that what moves never depends on what is drawn.
[[nodiscard]] double coveredRatio(const std::vector<Actor>& actors, const Pose& T_world_robot,
                                  const StereoCamera& camera);

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

/// Sets an observation's box and truncation: its whole box cut at the edges of an image.
///
/// @return false if nothing of it is inside the image
[[nodiscard]] bool cutToImage(const Box2d& whole, const cv::Size& image, Observation& observation);

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
