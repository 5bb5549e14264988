// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/opengl/CSetOfTexturedTriangles.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "mesh.h"

namespace headway::sim {

/// Textured triangles as MRPT draws them, unlit and with trilinear mipmaps.
///
/// MRPT uploads a texture without mipmaps, so far surfaces would shimmer; and its lit shader bends
/// far geometry, so light is off and shading belongs into the texture. Made with make_shared, not
/// with MRPT's factory, and for drawing only (never serialised).
class TexturedObject : public mrpt::opengl::CSetOfTexturedTriangles {
 public:
  using Ptr = std::shared_ptr<TexturedObject>;

  /// @param picture  8-bit BGR, or BGRA where it is partly transparent; sides powers of two
  explicit TexturedObject(const cv::Mat& picture);

  /// Draws these triangles from now on.
  void setMeshes(const std::vector<const Mesh*>& meshes);
  void setMesh(const Mesh& mesh) { setMeshes({&mesh}); }
  /// Draws fronts only: half of what closed meshes have; the other half is never visible.
  void hideBacks() { hides_backs_ = true; }
  /// Where the meshes are, and when they are drawn: MRPT draws from far to near, by a point that
  /// each object names. What is opaque names points far ahead, in reverse: near things are drawn
  /// first and spare the shading of what they hide.
  ///
  /// @param at       in the scene's frame [m]
  /// @param forward  unit vector of the viewing direction
  /// @param order    the greater, the earlier it is drawn
  void placeAt(const Eigen::Vector3d& at, const Eigen::Vector3d& forward, double order);
  void initializeTextures() const override;
  void render(const RenderContext& context) const override;

 private:
  bool hides_backs_ = false;
  mutable bool has_mipmaps_ = false;
};

}  // namespace headway::sim
