// SPDX-License-Identifier: BSD-3-Clause
// OpenGL objects of a scene: textured meshes, actors and their shadows.
#pragma once

#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfTexturedTriangles.h>

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "actor.h"
#include "grain.h"
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

/// Soft dark spot, BGRA: what a body takes from the light of an overcast sky.
[[nodiscard]] cv::Mat drawShadow();

/// The spot on the ground below an actor, relative to `origin`.
[[nodiscard]] Mesh shadowMesh(const Actor& actor, const Eigen::Vector3d& origin);

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
