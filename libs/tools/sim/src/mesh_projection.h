// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_camera.h>

#include <array>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <vector>

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

}  // namespace headway::sim
