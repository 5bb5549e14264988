#pragma once

#include <headway/core/error.h>
#include <headway/render/pinhole_view.h>

#include <memory>
#include <opencv2/core/mat.hpp>

namespace mrpt::opengl {
class COpenGLScene;
}

namespace headway::render {

/// No off-screen OpenGL can be had; what() says which packages to install. Callers may go on
/// without pictures.
class RendererUnavailable : public InputError {
 public:
  using InputError::InputError;
};

/// Draws 3D scenes to pictures without a display.
///
/// Making one costs about 0.2 s and each picture a few ms, so make it once. It belongs to the
/// thread that made it, and there may be one in each thread. The same scene and view give the
/// same bytes on one machine.
///
///     OffscreenRenderer renderer(1280, 720);
///     cv::Mat picture = renderer.draw(scene, view);
class OffscreenRenderer {
 public:
  /// @param width, height   of the pictures [px], any size from 1 x 1
  /// @param supersampling   drawn this many times larger and averaged down, 1 to 4: smooth edges
  /// @throws RendererUnavailable
  OffscreenRenderer(int width, int height, int supersampling = 1);
  ~OffscreenRenderer();
  OffscreenRenderer(OffscreenRenderer&&) noexcept;
  OffscreenRenderer& operator=(OffscreenRenderer&&) noexcept;

  /// @param view  of this renderer's width and height
  /// @return      8-bit BGR, height x width
  [[nodiscard]] cv::Mat draw(const mrpt::opengl::COpenGLScene& scene, const PinholeView& view);

 private:
  class Framebuffer;
  std::unique_ptr<Framebuffer> framebuffer_;
};

}  // namespace headway::render
