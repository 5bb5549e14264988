// SPDX-License-Identifier: BSD-3-Clause
#define GL_GLEXT_PROTOTYPES
#include "render_target.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <opencv2/imgproc.hpp>

namespace headway::sim {
RenderTarget::RenderTarget(int width, int height) : width_(width), height_(height) {
  buffer_.create(static_cast<unsigned>(width), static_cast<unsigned>(height));
}

void RenderTarget::draw(const mrpt::opengl::COpenGLScene& scene) {
  const auto before = buffer_.bind();
  glViewport(0, 0, width_, height_);
  glEnable(GL_DEPTH_TEST);
  scene.getViewport()->render(width_, height_);
  glFlush();
  const auto matrices = scene.getViewport()->getRenderMatrices();
  near_ = matrices.getLastClipZNear();
  far_ = matrices.getLastClipZFar();
  MrptFramebuffer::Bind(before);
}

cv::Mat RenderTarget::read(unsigned format, unsigned type, int depth, const cv::Size& kept) {
  const auto before = buffer_.bind();
  cv::Mat& pixels = depth == CV_32S ? codes_ : pixels_;
  pixels.create(height_, width_, depth);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, format, type, pixels.data);
  MrptFramebuffer::Bind(before);
  // OpenGL's rows begin at the bottom.
  return pixels(cv::Rect(0, height_ - kept.height, kept.width, kept.height));
}

cv::Mat RenderTarget::picture(const cv::Size& kept) {
  const cv::Mat pixels = read(GL_RGBA, GL_UNSIGNED_BYTE, CV_8UC4, kept);
  cv::Mat picture;
  cv::cvtColor(pixels, picture, cv::COLOR_RGBA2BGR);
  cv::flip(picture, picture, 0);
  return picture;
}

cv::Mat RenderTarget::depth(const cv::Size& kept, float farthest) {
  const cv::Mat pixels = read(HEADWAY_MRPT_DEPTH_PIXELS, CV_32S, kept);
  // Depths in the buffer are evenly spaced in 1/z, from 0 at the near plane to 2^24 - 1.
  const double nearest = 1.0 / near_;
  const double step = (1.0 / near_ - 1.0 / far_) / 0xFFFFFF;
  cv::Mat depth(kept, CV_32F);
  for (int v = 0; v < kept.height; ++v) {
    const auto* coded = pixels.ptr<std::uint32_t>(kept.height - 1 - v);
    auto* row = depth.ptr<float>(v);
    for (int u = 0; u < kept.width; ++u) {
      const auto code = static_cast<std::int32_t>(coded[u] >> 8U);
      const auto z = static_cast<float>(1.0 / (nearest - step * code));
      row[u] = z > farthest ? 0.0F : z;
    }
  }
  return depth;
}

}  // namespace headway::sim
