// SPDX-License-Identifier: BSD-3-Clause
// The frames that a rig takes of an environment.
#include "frame_drawer.h"

#include <algorithm>
#include <utility>

#include "actor_mesh.h"
#include "street.h"

namespace headway::sim {
namespace {

enum DrawerPurpose : std::uint64_t { kImageSeed = 304, kDetectorSeed, kFlexSeed = 309 };

std::uint64_t drawerSeed(DrawerPurpose purpose, const SimParams& params) {
  return seedOf({static_cast<std::uint64_t>(params.world.seed), purpose});
}

}  // namespace

FrameDrawer::FrameDrawer(const SimParams& params)
    : params_(params),
      lens_(params.camera, params.calibration_error),
      finisher_(params, lens_, drawerSeed(kImageSeed, params), drawerSeed(kDetectorSeed, params)) {}

double FrameDrawer::blurPause() const {
  const int samples = params_.camera.blur_samples;
  return samples > 1 ? params_.camera.exposure_s / (samples - 1) : 0.0;
}

DrawnFrame FrameDrawer::draw(Environment& environment, std::size_t trigger, const PassTime& pass) {
  if (!rig_) rig_.emplace(lens_.drawn(), environment.makeScene(lens_.drawn()));
  DrawnFrame drawn;
  drawn.trigger = trigger - 1;
  const int samples = params_.camera.blur_samples;
  const Pose T_left_right = bentRig(trigger);
  cv::Mat left_sum, right_sum;
  for (int i = 0; i < samples; ++i) {
    const Time now = pass(i > 0 ? blurPause() : 0.0);
    const auto actors = actorsInView(environment);
    const bool is_middle = i == samples / 2;
    const Pose T_world_robot = environment.T_world_robot();
    auto meshes = actorMeshes(actors, T_world_robot.translation());
    StereoDrawing drawing = rig_->draw(T_world_robot, T_left_right, actors, meshes, is_middle);
    if (is_middle) {
      drawn.frame.time = now;
      drawn.depth = drawing.depth;
      drawn.actors = actors;
      drawn.meshes = std::move(meshes);
      drawn.T_world_robot = T_world_robot;
    }
    if (samples == 1) {
      drawn.left = drawing.left;
      drawn.right = drawing.right;
      return drawn;
    }
    cv::Mat left, right;
    drawing.left.convertTo(left, CV_16UC3);
    drawing.right.convertTo(right, CV_16UC3);
    left_sum = left_sum.empty() ? left : cv::Mat(left_sum + left);
    right_sum = right_sum.empty() ? right : cv::Mat(right_sum + right);
  }
  left_sum.convertTo(drawn.left, CV_8UC3, 1.0 / samples);
  right_sum.convertTo(drawn.right, CV_8UC3, 1.0 / samples);
  return drawn;
}

std::vector<Actor> FrameDrawer::actorsInView(Environment& environment) const {
  std::vector<Actor> actors = environment.actors(params_.world.view_distance_m);
  // With 2 m for the shadow and the other camera's place.
  const ViewCone view = viewCone(lens_.drawn(), environment.T_world_robot());
  actors.erase(std::remove_if(actors.begin(), actors.end(),
                              [&](const Actor& actor) {
                                return !view.touches(actor.position.head<2>(),
                                                     0.5 * actor.size.head<2>().norm() + 2.0);
                              }),
               actors.end());
  return actors;
}

Pose FrameDrawer::bentRig(std::size_t frame) const {
  Random random(seedOf({drawerSeed(kFlexSeed, params_), frame}));
  const double sigma = params_.calibration_error.flex_deg * M_PI / 180.0;
  const double x = random.normal(), y = random.normal(), z = random.normal();
  Pose T_left_right = lens_.T_left_right();
  T_left_right.linear() *= expSo3(sigma * Eigen::Vector3d(x, y, z));
  return T_left_right;
}

}  // namespace headway::sim
