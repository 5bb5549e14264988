#include "frame_finisher.h"

#include <algorithm>
#include <cmath>

#include "visibility.h"

namespace headway::sim {
namespace {

/// The sighting as the recorded image shows it: its box bent by the lens and cut anew.
///
/// @return false if nothing of it is inside the recorded image
bool recordBox(const Lens& lens, Sighting& sighting) {
  const Box2d whole = lens.record(sighting.whole);
  Box2d& box = sighting.box;
  box = {std::max(whole.left, 0.0), std::max(whole.top, 0.0),
         std::min(whole.right, lens.ideal().width - 1.0),
         std::min(whole.bottom, lens.ideal().height - 1.0)};
  if (box.width() <= 0.0 || box.height() <= 0.0) return false;
  sighting.truncation =
      std::clamp(1.0 - box.width() * box.height() / (whole.width() * whole.height()), 0.0, 1.0);
  return true;
}

TruthObject truthOf(const Mover& mover, const Sighting& sighting, const Pose& T_map_world) {
  TruthObject object;
  object.id = mover.id;
  object.object_class = classOf(mover.kind);
  object.parked = mover.parked;
  object.box3d = sighting.box3d;
  object.box2d = sighting.box;
  object.truncation = sighting.truncation;
  object.visible = sighting.visible;
  object.occlusion = occlusionLevel(sighting.visible);
  object.position = T_map_world * mover.centre();
  object.velocity =
      T_map_world.linear() * Eigen::Vector3d(mover.velocity.x(), mover.velocity.y(), 0.0);
  const Eigen::Vector3d front =
      T_map_world.linear() * Eigen::Vector3d(std::cos(mover.yaw), std::sin(mover.yaw), 0.0);
  object.yaw = std::atan2(front.y(), front.x());
  object.size = mover.size;
  return object;
}

}  // namespace

FrameFinisher::FrameFinisher(const SimParams& params, const Lens& lens, std::uint64_t image_seed,
                             std::uint64_t detector_seed)
    : lens_(lens),
      truth_range_m_(params.recording.truth_range_m),
      image_formation_(params.camera, params.camera.width, params.camera.height, image_seed),
      detector_(params.detector, lens.ideal(), detector_seed) {}

void FrameFinisher::judge(SimFrame& frame, const DrawnFrame& drawn) {
  if (!T_map_world_) T_map_world_ = drawn.T_world_robot.inverse();
  frame.T_map_robot = *T_map_world_ * drawn.T_world_robot;
  auto sightings = findSightings(drawn.T_world_robot, lens_.drawn(), drawn.movers, drawn.bodies,
                                 drawn.depth, frame.instances);
  sightings.erase(std::remove_if(sightings.begin(), sightings.end(),
                                 [&](Sighting& sighting) { return !recordBox(lens_, sighting); }),
                  sightings.end());
  std::vector<std::uint16_t> numbers(drawn.movers.size() + 1, 0);
  for (const Sighting& sighting : sightings) {
    const Mover& mover = drawn.movers[sighting.mover];
    const bool hidden_for_good = mover.parked && sighting.visible_pixels == 0;
    if (hidden_for_good || sighting.box3d.centre.z() > truth_range_m_) continue;
    frame.objects.push_back(truthOf(mover, sighting, *T_map_world_));
    numbers[sighting.mover + 1] = static_cast<std::uint16_t>(frame.objects.size());
  }
  for (int v = 0; v < frame.instances.rows; ++v) {
    auto* row = frame.instances.ptr<std::uint16_t>(v);
    std::transform(row, row + frame.instances.cols, row,
                   [&](std::uint16_t mover) { return numbers[mover]; });
  }
  frame.depth = lens_.record(drawn.depth, false);
  frame.instances = lens_.record(frame.instances, false);
  frame.detections = detector_.detect(frame.time, drawn.movers, sightings, frame.depth);
}

SimFrame FrameFinisher::finish(DrawnFrame drawn) {
  SimFrame frame = std::move(drawn.frame);
  judge(frame, drawn);
  using Side = ImageFormation::Side;
  const auto exposed = [&](const cv::Mat& drawing, Side side) {
    return image_formation_.expose(lens_.record(drawing, true), drawn.trigger, side);
  };
  frame.left = exposed(drawn.left, Side::kLeft);
  frame.right = exposed(drawn.right, Side::kRight);
  return frame;
}

}  // namespace headway::sim
