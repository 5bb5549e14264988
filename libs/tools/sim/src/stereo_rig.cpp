// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_rig.h"

#include <mrpt/opengl/CFBORender.h>

#include <utility>

#include "render_target.h"

namespace headway::sim {
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
