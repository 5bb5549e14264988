// SPDX-License-Identifier: BSD-3-Clause
// Finishing of drawn frames: truth, detections and sensor effects.
#include "frame_finisher.h"

#include <algorithm>
#include <cmath>

#include "mesh_projection.h"

namespace headway::sim {

SimulatedDetector::SimulatedDetector(const DetectorParams& params, const StereoCamera& camera,
                                     std::uint64_t seed)
    : params_(params), camera_(camera), random_(seed) {}

bool SimulatedDetector::isMissed(const Actor& actor, const Observation& observation) {
  const double z = observation.box3d.centre.z();
  if (z > params_.max_range_m || observation.box.height() < params_.min_height_px) return true;
  if (actor.parked && !params_.parked) return true;
  // Of what leaves the image nothing is known, unless it still fills 5 % of it.
  const bool cut_off =
      observation.truncation > 0.8 &&
      observation.box.width() * observation.box.height() < 0.05 * camera_.width * camera_.height;
  if (observation.visible_pixels == 0 || cut_off || z < 0.5) return true;
  const double far = z / params_.max_range_m;
  const double hidden = 1.0 - observation.visible;
  const double in_view = params_.miss_near + (params_.miss_far - params_.miss_near) * far * far;
  const double missed = in_view + (params_.miss_occluded - in_view) * hidden * hidden;
  return random_.chance(std::clamp(missed, 0.0, 1.0));
}

DetectorNoise SimulatedDetector::noiseAt(double depth_m) const {
  DetectorNoise noise;
  noise.along_sigma_m = params_.depth_sigma_m;
  noise.across_sigma_m = params_.position_sigma_m;
  noise.vertical_variance_ratio = 0.16;
  noise.size_sigma_ratio = params_.size_sigma;
  noise.yaw_sigma_rad = params_.yaw_sigma_rad;
  noise.flip_probability = params_.flip_probability;
  return withCentreScaled(noise, std::max(1.0, depth_m / 20.0));  // as DetectorParams says
}

Detection SimulatedDetector::measure(const Actor& actor, const Observation& observation) {
  Detection detection;
  detection.object_class = classOf(actor.kind);
  const double z = observation.box3d.centre.z();
  detection.score = std::clamp(0.95 - 0.4 * z / params_.max_range_m -
                                   0.35 * (1.0 - observation.visible) + 0.07 * random_.normal(),
                               0.05, 1.0);
  const auto edge = [&](double value) { return value + params_.box_sigma_px * random_.normal(); };
  detection.box2d = Box2d{edge(observation.box.left), edge(observation.box.top),
                          edge(observation.box.right), edge(observation.box.bottom)};
  const DetectorNoise noise = noiseAt(z);
  detection.box3d = measuredBox(observation.box3d, noise, random_);
  detection.centre_covariance = centreCovariance(observation.box3d.centre, noise);
  finish(detection);
  return detection;
}

Detection SimulatedDetector::falseAlarm(const cv::Mat& depth) {
  const ObjectClass object_class =
      random_.chance(0.5) ? ObjectClass::kPedestrian : ObjectClass::kCar;
  const bool person = object_class == ObjectClass::kPedestrian;
  Detection detection;
  detection.object_class = object_class;
  detection.score = random_.uniform(0.1, 0.6);
  detection.detector_id = next_id_++;
  const int u = random_.below(depth.cols), v = depth.rows / 3 + random_.below(depth.rows * 2 / 3);
  const double seen = depth.at<float>(v, u);
  const double z = std::clamp(seen > 0.0 ? seen : 30.0, 4.0, params_.max_range_m);
  Box3d box;
  box.length = person ? 0.8 : 4.2;
  box.width = person ? 0.6 : 1.75;
  box.height = person ? 1.7 : 1.5;
  box.centre = z * ray(Eigen::Vector2d(u, v), camera_);
  box.yaw = random_.uniform(-M_PI, M_PI);
  detection.box3d = box;
  const double half_width =
      0.5 * camera_.fx * (person ? box.width : 0.5 * (box.length + box.width)) / z;
  const double half_height = 0.5 * camera_.fy * box.height / z;
  detection.box2d = Box2d{u - half_width, v - half_height, u + half_width, v + half_height};
  finish(detection);
  return detection;
}

void SimulatedDetector::finish(Detection& detection) const {
  Box2d& box = *detection.box2d;
  box.left = std::clamp(box.left, 0.0, camera_.width - 2.0);
  box.top = std::clamp(box.top, 0.0, camera_.height - 2.0);
  box.right = std::clamp(box.right, box.left + 1.0, camera_.width - 1.0);
  box.bottom = std::clamp(box.bottom, box.top + 1.0, camera_.height - 1.0);
  if (!params_.boxes_2d) detection.box2d.reset();
  if (!params_.boxes_3d) {
    detection.box3d.reset();
    detection.centre_covariance.reset();
  }
}

Detections SimulatedDetector::detect(Time time, const std::vector<Actor>& actors,
                                     const std::vector<Observation>& observations,
                                     const cv::Mat& depth) {
  Detections detections;
  detections.time = time;
  detections.T_robot_sensor = camera_.T_robot_cam;
  detections.image_width = camera_.width;
  detections.image_height = camera_.height;
  for (const Observation& observation : observations) {
    const Actor& actor = actors[observation.actor];
    if (isMissed(actor, observation)) continue;
    auto& id = detector_ids_[actor.id];
    if (id == 0 || random_.chance(params_.id_switch_probability)) id = next_id_++;
    detections.items.push_back(measure(actor, observation));
    detections.items.back().detector_id = id;
    if (!random_.chance(params_.duplicate_probability)) continue;
    detections.items.push_back(measure(actor, observation));
    detections.items.back().score *= 0.6;
    detections.items.back().detector_id = next_id_++;
  }
  double expected = params_.false_per_frame;
  for (; expected > 0.0; expected -= 1.0) {
    if (random_.chance(std::min(1.0, expected))) detections.items.push_back(falseAlarm(depth));
  }
  return detections;
}

namespace {

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
  // As the recorded image shows them: boxes bent by the lens and cut anew.
  const cv::Size recorded(lens_.ideal().width, lens_.ideal().height);
  observations.erase(std::remove_if(observations.begin(), observations.end(),
                                    [&](Observation& observation) {
                                      return !cutToImage(lens_.record(observation.whole), recorded,
                                                         observation);
                                    }),
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
