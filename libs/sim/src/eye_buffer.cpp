#define GL_GLEXT_PROTOTYPES
#include "eye_buffer.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <opencv2/imgproc.hpp>

namespace headway::sim {
namespace {

// The table that MRPT's CFBORender takes depths from, with its size, so that truth is the same byte
// for byte whichever of the two draws. Depths come out up to 0.03 % short at 20 m, 0.2 % at 120 m.
constexpr std::size_t kTableSize = 1U << 18U;

/// Metres for depths from -1 to 1, evenly spaced; the buffer's are 0 at `near` and 1 at `far`.
std::vector<float> distanceTable(float near, float far) {
  std::vector<float> metres(kTableSize);
  for (std::size_t i = 0; i < kTableSize; ++i) {
    float depth = -1.0F + 2.0F * static_cast<float>(i) / (kTableSize - 1);
    depth = 2.0F * depth - 1.0F;
    metres[i] = 2.0F * near * far / (far + near - depth * (far - near));
  }
  metres.back() = 0.0F;  // nothing was drawn
  return metres;
}

}  // namespace

EyeBuffer::EyeBuffer(int width, int height) : width_(width), height_(height) {
  buffer_.create(static_cast<unsigned>(width), static_cast<unsigned>(height));
}

void EyeBuffer::draw(const mrpt::opengl::COpenGLScene& scene) {
  const auto before = buffer_.bind();
  glViewport(0, 0, width_, height_);
  glEnable(GL_DEPTH_TEST);
  scene.getViewport()->render(width_, height_);
  glFlush();
  const auto matrices = scene.getViewport()->getRenderMatrices();
  near_ = matrices.getLastClipZNear();
  far_ = matrices.getLastClipZFar();
  mrpt::opengl::COpenGLFramebuffer::Bind(before);
}

cv::Mat EyeBuffer::read(unsigned format, unsigned type, int depth, const cv::Size& kept) {
  const auto before = buffer_.bind();
  cv::Mat& pixels = depth == CV_32S ? codes_ : pixels_;
  pixels.create(height_, width_, depth);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width_, height_, format, type, pixels.data);
  mrpt::opengl::COpenGLFramebuffer::Bind(before);
  // OpenGL's rows begin at the bottom.
  return pixels(cv::Rect(0, height_ - kept.height, kept.width, kept.height));
}

cv::Mat EyeBuffer::picture(const cv::Size& kept) {
  const cv::Mat pixels = read(GL_RGBA, GL_UNSIGNED_BYTE, CV_8UC4, kept);
  cv::Mat picture;
  cv::cvtColor(pixels, picture, cv::COLOR_RGBA2BGR);
  cv::flip(picture, picture, 0);
  return picture;
}

cv::Mat EyeBuffer::depth(const cv::Size& kept) {
  const cv::Mat pixels = read(GL_DEPTH_STENCIL, GL_UNSIGNED_INT_24_8, CV_32S, kept);
  if (metres_.empty()) metres_ = distanceTable(near_, far_);
  cv::Mat depth(kept, CV_32F);
  for (int v = 0; v < kept.height; ++v) {
    const auto* coded = pixels.ptr<std::uint32_t>(kept.height - 1 - v);
    auto* row = depth.ptr<float>(v);
    for (int u = 0; u < kept.width; ++u) {
      constexpr double kCodeStep = 1.0 / 0xFFFFFF;
      const auto share = static_cast<float>(kCodeStep * (coded[u] >> 8U));
      row[u] = metres_[static_cast<std::size_t>((share + 1.0F) * (kTableSize - 1) / 2)];
    }
  }
  return depth;
}

}  // namespace headway::sim
