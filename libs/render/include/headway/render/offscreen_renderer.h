// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/error.h>
#include <headway/core/mrpt_compat.h>
#include <headway/render/pinhole_view.h>

#include <memory>
#include <opencv2/core/mat.hpp>

namespace headway::render {

/// Off-screen OpenGL is not available; what() names the packages to install. Callers may continue
/// without pictures.
class RendererUnavailable : public InputError {
 public:
  using InputError::InputError;
};

/// Renders 3D scenes to pictures without a display.
///
/// Construction takes about 0.2 s and each picture a few ms, so reuse the object. It may only be
/// used in the thread that created it; several threads may have one each. The same scene and view
/// give the same bytes on one machine.
///
///     OffscreenRenderer renderer(1280, 720);
///     cv::Mat picture = renderer.draw(scene, view);
class OffscreenRenderer {
 public:
  /// @param width, height   of the pictures [px], any size from 1 x 1
  /// @param supersampling   factor of the rendered to the final size, 1 to 4, for antialiasing
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
