// SPDX-License-Identifier: BSD-3-Clause
// The off-screen drawing of a scene by two cameras.
#define GL_GLEXT_PROTOTYPES

#include "stereo_rig.h"

#include <GL/gl.h>
#include <GL/glext.h>
#include <headway/core/mrpt_compat.h>
#include <mrpt/opengl/CFBORender.h>

#include <opencv2/imgproc.hpp>
#include <utility>
#include HEADWAY_MRPT_FRAMEBUFFER

namespace headway::sim {

/// The image of one camera, drawn off-screen.
///
/// Drawing and reading are apart, so that a second image can be set up while the first is drawn,
/// and pixels are read in the driver's own format. Needs an OpenGL context that is current, in one
/// thread, for as long as it lives.
class RenderTarget {
 public:
  /// @param width  a multiple of four
  RenderTarget(int width, int height);

  /// Begins to draw the scene as its main camera sees it; returns before that is done.
  void draw(const mrpt::opengl::COpenGLScene& scene);

  /// @return 8-bit BGR, the upper left part of what was drawn
  [[nodiscard]] cv::Mat picture(const cv::Size& kept);
  /// @param farthest  less than what is drawn at most [m]
  /// @return 32-bit, distance from the camera's plane [m]; 0 where nothing so near was drawn
  [[nodiscard]] cv::Mat depth(const cv::Size& kept, float farthest);

 private:
  cv::Mat read(unsigned format, unsigned type, int depth, const cv::Size& kept);

  MrptFramebuffer buffer_;
  cv::Mat pixels_, codes_;  ///< as read: colours, depths
  int width_;
  int height_;
  float near_ = 0.0F, far_ = 0.0F;  ///< what the depths drawn range over [m]
};

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

namespace {

/// Rows of a picture whose width MRPT can read back: a multiple of four.
int drawnWidth(int width) { return (width + 3) / 4 * 4; }

}  // namespace

/// A scene and the images of its two cameras.
class StereoRig::Renderer {
 public:
  Renderer(const StereoCamera& camera, std::unique_ptr<Scene> scene);

  [[nodiscard]] Scene& scene() { return *scene_; }
  void drawLeft() { draw(camera_.T_robot_cam, left_); }
  void drawRight(const Pose& T_left_right) { draw(camera_.T_robot_cam * T_left_right, right_); }
  [[nodiscard]] StereoDrawing read(bool with_depth);

 private:
  void draw(const Pose& T_robot_cam, RenderTarget& target);

  StereoCamera camera_;
  std::unique_ptr<Scene> scene_;
  mrpt::opengl::CFBORender context_;  ///< of OpenGL, off-screen
  RenderTarget left_, right_;
};

StereoRig::Renderer::Renderer(const StereoCamera& camera, std::unique_ptr<Scene> scene)
    : camera_(camera),
      scene_(std::move(scene)),
      context_(static_cast<unsigned>(drawnWidth(camera.width)),
               static_cast<unsigned>(camera.height)),
      left_(drawnWidth(camera.width), camera.height),
      right_(drawnWidth(camera.width), camera.height) {}

void StereoRig::Renderer::draw(const Pose& T_robot_cam, RenderTarget& target) {
  mrpt::img::TCamera lens;
  lens.ncols = static_cast<unsigned>(drawnWidth(camera_.width));
  lens.nrows = static_cast<unsigned>(camera_.height);
  // OpenGL's pixels have their centres at halves, ours at integers.
  lens.setIntrinsicParamsFromValues(camera_.fx, camera_.fy, camera_.cx + 0.5, camera_.cy + 0.5);
  mrpt::opengl::CCamera camera;
  camera.set6DOFMode(true);
  camera.setProjectiveFromPinhole(lens);
  const Pose T_origin_cam = scene_->T_origin_robot() * T_robot_cam;
  camera.setPose(mrpt::poses::CPose3D(mrpt::math::CMatrixDouble44(T_origin_cam.matrix())));
  scene_->scene().getViewport()->getCamera() = camera;
  target.draw(scene_->scene());
}

StereoDrawing StereoRig::Renderer::read(bool with_depth) {
  const cv::Size size(camera_.width, camera_.height);
  StereoDrawing drawing;
  drawing.left = left_.picture(size);
  // The sky's drum is not a distance.
  if (with_depth) drawing.depth = left_.depth(size, 0.8F * kSkyRadius);
  drawing.right = right_.picture(size);
  return drawing;
}

StereoRig::StereoRig(const StereoCamera& camera, std::unique_ptr<Scene> scene)
    : renderer_(std::make_unique<Renderer>(camera, std::move(scene))) {}

StereoRig::~StereoRig() = default;

StereoDrawing StereoRig::draw(const Pose& T_world_robot, const Pose& T_left_right,
                              const std::vector<Actor>& actors, const std::vector<Mesh>& meshes,
                              bool with_depth) {
  renderer_->scene().arrange(T_world_robot, T_left_right, actors, meshes);
  renderer_->drawLeft();
  renderer_->drawRight(T_left_right);
  return renderer_->read(with_depth);
}

}  // namespace headway::sim
