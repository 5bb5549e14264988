// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/mrpt_pose.h>
#include <headway/render/offscreen_renderer.h>
#include <mrpt/opengl/CFBORender.h>

#include <opencv2/imgproc.hpp>
#include <string>

namespace headway::render {
namespace {

/// Width rounded up to a multiple of four; MRPT distorts pictures of other widths.
int roundedUpToFour(int width) { return (width + 3) / 4 * 4; }

/// MRPT camera of a view for a picture `scale` times as large.
///
/// OpenGL's pixel centres are at halves, headway's at integers.
mrpt::opengl::CCamera cameraOf(const PinholeView& view, int scale, int drawn_width) {
  mrpt::img::TCamera pinhole;
  pinhole.ncols = static_cast<std::uint32_t>(drawn_width);
  pinhole.nrows = static_cast<std::uint32_t>(view.height * scale);
  pinhole.setIntrinsicParamsFromValues(view.fx * scale, view.fy * scale, (view.cx + 0.5) * scale,
                                       (view.cy + 0.5) * scale);
  mrpt::opengl::CCamera camera;
  camera.set6DOFMode(true);
  camera.setProjectiveFromPinhole(pinhole);
  camera.setPose(toMrpt(view.T_map_camera));
  return camera;
}

std::string reasonOf(const std::exception& error) {
  std::string text = error.what();
  for (char& c : text) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  return text;
}

}  // namespace

class OffscreenRenderer::Framebuffer {
 public:
  Framebuffer(int width, int height, int supersampling)
      : width_(width),
        height_(height),
        scale_(supersampling),
        drawn_width_(roundedUpToFour(width * supersampling)),
        renderer_(static_cast<unsigned>(drawn_width_),
                  static_cast<unsigned>(height * supersampling)) {}

  cv::Mat draw(const mrpt::opengl::COpenGLScene& scene, const PinholeView& view) {
    ASSERTMSG_(view.width == width_ && view.height == height_,
               "the view's size differs from the renderer's");
    scene.getViewport()->setViewportClipDistances(static_cast<float>(view.near_m),
                                                  static_cast<float>(view.far_m));
    renderer_.setCamera(scene, cameraOf(view, scale_, drawn_width_));
    renderer_.render_RGB(scene, drawn_);
    const cv::Mat whole = drawn_.asCvMat<cv::Mat>(mrpt::img::SHALLOW_COPY);
    const cv::Mat cropped = whole(cv::Rect(0, 0, width_ * scale_, height_ * scale_));
    if (scale_ == 1) return cropped.clone();
    cv::Mat picture;
    cv::resize(cropped, picture, cv::Size(width_, height_), 0.0, 0.0, cv::INTER_AREA);
    return picture;
  }

 private:
  int width_;
  int height_;
  int scale_;
  int drawn_width_;
  mrpt::opengl::CFBORender renderer_;
  mrpt::img::CImage drawn_;
};

OffscreenRenderer::OffscreenRenderer(int width, int height, int supersampling) {
  ASSERTMSG_(width > 0 && height > 0, "the picture size must be positive");
  ASSERTMSG_(supersampling >= 1 && supersampling <= 4, "supersampling must be 1 to 4");
  try {
    framebuffer_ = std::make_unique<Framebuffer>(width, height, supersampling);
  } catch (const std::exception& error) {
    throw RendererUnavailable(
        "off-screen OpenGL is not available; install libegl1 and libgl1-mesa-dri (" +
        reasonOf(error) + ")");
  }
}

OffscreenRenderer::~OffscreenRenderer() = default;
OffscreenRenderer::OffscreenRenderer(OffscreenRenderer&&) noexcept = default;
OffscreenRenderer& OffscreenRenderer::operator=(OffscreenRenderer&&) noexcept = default;

cv::Mat OffscreenRenderer::draw(const mrpt::opengl::COpenGLScene& scene, const PinholeView& view) {
  return framebuffer_->draw(scene, view);
}

}  // namespace headway::render
