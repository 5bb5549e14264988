// SPDX-License-Identifier: BSD-3-Clause
#include "frame_finisher.h"

#include <algorithm>
#include <cmath>

#include "visibility.h"

namespace headway::sim {
namespace {

/// The observation as the recorded image shows it: its box bent by the lens and cut anew.
///
/// @return false if nothing of it is inside the recorded image
bool recordBox(const Lens& lens, Observation& observation) {
  const Box2d whole = lens.record(observation.whole);
  Box2d& box = observation.box;
  box = {std::max(whole.left, 0.0), std::max(whole.top, 0.0),
         std::min(whole.right, lens.ideal().width - 1.0),
         std::min(whole.bottom, lens.ideal().height - 1.0)};
  if (box.width() <= 0.0 || box.height() <= 0.0) return false;
  observation.truncation =
      std::clamp(1.0 - box.width() * box.height() / (whole.width() * whole.height()), 0.0, 1.0);
  return true;
}

TruthObject truthOf(const Actor& actor, const Observation& observation, const Pose& T_map_world) {
  TruthObject object;
  object.id = actor.id;
  object.object_class = classOf(actor.kind);
  object.parked = actor.parked;
  object.box3d = observation.box3d;
  object.box2d = observation.box;
  object.truncation = observation.truncation;
  object.visible = observation.visible;
  object.occlusion = occlusionLevel(observation.visible);
  object.position = T_map_world * actor.centre();
  object.velocity =
      T_map_world.linear() * Eigen::Vector3d(actor.velocity.x(), actor.velocity.y(), 0.0);
  const Eigen::Vector3d front =
      T_map_world.linear() * Eigen::Vector3d(std::cos(actor.yaw), std::sin(actor.yaw), 0.0);
  object.yaw = std::atan2(front.y(), front.x());
  object.size = actor.size;
  return object;
}

}  // namespace

FrameFinisher::FrameFinisher(const SimParams& params, const Lens& lens, std::uint64_t image_seed,
                             std::uint64_t detector_seed)
    : lens_(lens),
      truth_range_m_(params.recording.truth_range_m),
      image_formation_(params.camera, params.camera.width, params.camera.height, image_seed),
      depth_sensor_(params.camera, lens.ideal(), image_seed),
      is_depth_camera_(params.camera.depth_camera),
      detector_(params.detector, lens.ideal(), detector_seed) {}

void FrameFinisher::annotate(SimFrame& frame, const DrawnFrame& drawn) {
  if (!T_map_world_) T_map_world_ = drawn.T_world_robot.inverse();
  frame.T_map_robot = *T_map_world_ * drawn.T_world_robot;
  for (Drop& drop : frame.drops) {
    for (Eigen::Vector2d& corner : drop.outline) {
      corner = (*T_map_world_ * Eigen::Vector3d(corner.x(), corner.y(), 0.0)).head<2>();
    }
  }
  auto observations = observeActors(drawn.T_world_robot, lens_.drawn(), drawn.actors, drawn.meshes,
                                    drawn.depth, frame.instances);
  observations.erase(
      std::remove_if(observations.begin(), observations.end(),
                     [&](Observation& observation) { return !recordBox(lens_, observation); }),
      observations.end());
  std::vector<std::uint16_t> numbers(drawn.actors.size() + 1, 0);
  for (const Observation& observation : observations) {
    const Actor& actor = drawn.actors[observation.actor];
    const bool hidden_for_good = actor.parked && observation.visible_pixels == 0;
    if (hidden_for_good || observation.box3d.centre.z() > truth_range_m_) continue;
    frame.objects.push_back(truthOf(actor, observation, *T_map_world_));
    numbers[observation.actor + 1] = static_cast<std::uint16_t>(frame.objects.size());
  }
  for (int v = 0; v < frame.instances.rows; ++v) {
    auto* row = frame.instances.ptr<std::uint16_t>(v);
    std::transform(row, row + frame.instances.cols, row,
                   [&](std::uint16_t actor) { return numbers[actor]; });
  }
  frame.depth = lens_.record(drawn.depth, false);
  frame.instances = lens_.record(frame.instances, false);
  frame.detections = detector_.detect(frame.time, drawn.actors, observations, frame.depth);
}

SimFrame FrameFinisher::finish(DrawnFrame drawn) {
  SimFrame frame = std::move(drawn.frame);
  annotate(frame, drawn);
  using Side = ImageFormation::Side;
  const auto exposed = [&](const cv::Mat& drawing, Side side) {
    return image_formation_.expose(lens_.record(drawing, true), drawn.trigger, side);
  };
  frame.left = exposed(drawn.left, Side::kLeft);
  if (is_depth_camera_) {
    frame.ranges = depth_sensor_.measure(frame.depth, drawn.trigger);
  } else {
    frame.right = exposed(drawn.right, Side::kRight);
  }
  return frame;
}

int occlusionLevel(double visible) {
  if (visible >= 0.8) return 0;
  if (visible >= 0.4) return 1;
  return visible >= 0.1 ? 2 : 3;
}

cv::Mat dynamicMask(const SimFrame& frame) {
  cv::Mat mask = cv::Mat::zeros(frame.instances.size(), CV_8U);
  for (int v = 0; v < mask.rows; ++v) {
    const auto* labels = frame.instances.ptr<std::uint16_t>(v);
    auto* marks = mask.ptr<uchar>(v);
    for (int u = 0; u < mask.cols; ++u) {
      if (labels[u] != 0 && !frame.objects[labels[u] - 1U].parked) marks[u] = 255;
    }
  }
  return mask;
}

}  // namespace headway::sim
