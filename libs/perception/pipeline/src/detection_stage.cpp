// SPDX-License-Identifier: BSD-3-Clause
// Detections of a frame from all sources, before and after the pose is known.
#include "detection_stage.h"

#include <headway/core/error.h>
#include <headway/detect/fusion.h>
#include <headway/detect/stereo_lifter.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>

namespace headway::pipeline {
namespace {

constexpr const char* kMotionDetector = "stereo_motion";
constexpr const char* kShapeDetector = "shape";
constexpr const char* kNetworkDetector = "dnn";
constexpr double kTestedDisparity_px = 8.0;  // from which motion along the line of sight shows

using Clock = std::chrono::steady_clock;

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool lacksDepth(const Detection& detection) { return detection.box2d && !detection.box3d; }

/// Networks trained on COCO report vans as trucks: the height, by stereo, tells them apart.
void correctTrucks(const StereoCamera& camera, const detect::StereoLifter& lifter,
                   Detections& detections) {
  for (Detection& item : detections.items) {
    if (item.object_class != ObjectClass::kTruck || !item.box2d) continue;
    const auto surface = lifter.surfaceOf(*item.box2d, ObjectClass::kVan);
    if (!surface) continue;
    const double depth = camera.fx * camera.baseline_m / surface->disparity;
    const double height = depth * item.box2d->height() / camera.fy;
    if (height < detect::kMaxVanHeight_m) item.object_class = ObjectClass::kVan;
  }
}

/// Records which detectors evaluated the frame of these detections, beside what stereo_motion says
/// of its own. That shapes do not show a person says nothing against one.
void setTested(bool by_network, Detections& detections) {
  for (Detection& item : detections.items) {
    item.evidence.classifier_tested = by_network || item.evidence.classifier;
  }
}

/// Places that 2D boxes are lifted to drift: by motion, what they show moves by that only, where it
/// is measurable.
void liftBoxes(bool by_motion, const StereoCamera& camera, const detect::StereoLifter& lifter,
               Detections& detections) {
  double range = camera.fx * camera.baseline_m / kTestedDisparity_px;
  if (camera.isDepthCamera()) range = std::min(range, camera.depth_reach_m);
  std::vector<Detection*> lifted;
  for (Detection& item : detections.items) {
    if (lacksDepth(item)) lifted.push_back(&item);
  }
  detect::liftAll(detections, lifter);
  for (Detection* item : lifted) {
    const bool is_measurable = by_motion && item->box3d && item->box3d->centre.z() < range;
    item->evidence.motion_tested = item->evidence.motion_tested || is_measurable;
  }
}

bool lackDepth(const Detections& detections) {
  return std::any_of(detections.items.begin(), detections.items.end(), lacksDepth);
}

}  // namespace

DetectionStage::DetectionStage(std::shared_ptr<const StereoCamera> camera,
                               const DetectionParams& params)
    : camera_(std::move(camera)),
      stereo_motion_params_(params.detect.stereo_motion),
      recorded_timeout_s_(params.recorded_timeout_s),
      use_recorded_(usesRecordedBoxes(params.detector)),
      automatic_(wouldUseModel(params)),
      period_s_(params.detect.period_s) {
  params.validate();
  const auto names = imageDetectors(params);
  has_network_ = std::count(names.begin(), names.end(), kNetworkDetector) > 0;
  if (camera_ == nullptr && !names.empty() && !automatic_) {
    throw InputError("[detect] detector = " + params.detector +
                     ": needs stereo images, and the recording holds none");
  }
  if (camera_ == nullptr) return;
  for (const auto& name : names) {
    if (name == kMotionDetector) {
      stereo_motion_.emplace(camera_, params.detect.stereo_motion);
    } else if (name == kShapeDetector) {
      shape_params_ = params.detect.shape;
      mountShape();
    } else {
      detectors_.push_back(detect::makeDetector(name, params.detect));
    }
  }
}

DetectionStage::~DetectionStage() = default;

/// On real streets it takes edges of vehicles for people now and then: unasked on robots only.
void DetectionStage::mountShape() {
  const bool is_robot = stereo::rigCapability(*camera_).meets_drops;
  const bool is_wanted = shape_params_ && (is_robot || !automatic_);
  if (!is_wanted) shape_.reset();
  if (is_wanted && !shape_) shape_.emplace(*shape_params_);
}

void DetectionStage::addRecorded(const RecordedFrame& frame, ObjectDetections& boxes) {
  if (frame.detections) {
    boxes.sources.push_back(camera_ != nullptr
                                ? inSensorFrame(*frame.detections, camera_->T_robot_cam)
                                : *frame.detections);
    for (auto& item : boxes.sources.back().items) item.evidence.classifier = true;
    last_recorded_ = frame.time;
    if (automatic_) stereo_motion_.reset();
  } else if (last_recorded_ && frame.time - *last_recorded_ > recorded_timeout_s_) {
    boxes.recorded_missing = true;
    if (automatic_ && camera_ != nullptr && !stereo_motion_) {
      stereo_motion_.emplace(camera_, stereo_motion_params_);
    }
  }
}

void DetectionStage::restart() {
  last_run_.reset();
  last_images_.reset();
  if (last_recorded_) last_recorded_ = -std::numeric_limits<double>::infinity();
  if (stereo_motion_) stereo_motion_.emplace(camera_, stereo_motion_params_);
}

void DetectionStage::remount(std::shared_ptr<const StereoCamera> camera) {
  camera_ = std::move(camera);
  if (stereo_motion_) stereo_motion_.emplace(camera_, stereo_motion_params_);
  mountShape();
}

bool DetectionStage::isDue(Time time) {
  const double half_interval = last_images_ ? 0.5 * (time - *last_images_) : 0.0;
  last_images_ = time;
  if (last_run_ && time + half_interval < *last_run_ + period_s_) return false;
  last_run_ = time;
  return true;
}

ObjectDetections DetectionStage::detectObjects(const RecordedFrame& frame,
                                               const std::optional<stereo::FrameContext>& context,
                                               bool is_new, bool ground_scanned) {
  const auto start = Clock::now();
  ObjectDetections boxes;
  boxes.context = context;
  if (use_recorded_) addRecorded(frame, boxes);
  // A frame of boxes or poses alone does not take the turn of one with images.
  const bool with_images = frame.stereo && is_new && (!automatic_ || stereo_motion_);
  const bool is_due = with_images && !detectors_.empty() && isDue(frame.time);
  boxes.detectors_run = with_images && (stereo_motion_ || shape_ || is_due);
  boxes.all_detectors_ran = is_due || detectors_.empty();
  boxes.classified = has_network_ && is_due;
  if (is_due) {
    for (const auto& detector : detectors_) {
      boxes.sources.push_back(detector->detect(*frame.stereo));
      for (auto& item : boxes.sources.back().items) item.evidence.periodic = true;
    }
  }
  boxes.lifting =
      frame.stereo && std::any_of(boxes.sources.begin(), boxes.sources.end(), lackDepth);
  if (boxes.lifting || (boxes.detectors_run && (stereo_motion_ || shape_)) || ground_scanned) {
    context->startMatching(matcher_);  // while SLAM runs
  }
  boxes.elapsed_ms = millisecondsSince(start);
  return boxes;
}

FrameDetections DetectionStage::detectMotion(const RecordedFrame& frame,
                                             const std::optional<Pose>& T_map_robot,
                                             const ObjectDetections& boxes,
                                             const std::vector<ExpectedObject>& expected,
                                             const detect::MotionDetections& previous) {
  const auto start = Clock::now();
  FrameDetections found;
  found.images_used = boxes.detectors_run || boxes.lifting;
  auto sources = boxes.sources;
  if (stereo_motion_ && boxes.detectors_run) {
    found.motion = stereo_motion_->detect(*boxes.context, T_map_robot, expected);
    found.dropped = found.motion.dropped;
    if (found.motion.detections) sources.push_back(*found.motion.detections);
  } else if (stereo_motion_) {
    found.motion = previous;
    found.motion.static_points.clear();
  }
  const bool by_shape = shape_ && boxes.detectors_run;
  if (by_shape) sources.push_back(shape_->detect(*boxes.context));
  detect::FusionParams fusion;
  fusion.rider_by_motion = boxes.classified;
  if (!sources.empty()) {
    auto fused = detect::fuse(sources, fusion);
    found.fused = std::move(fused.detections);
    found.fused->all_detectors_ran = boxes.all_detectors_ran;
    for (const auto& [reason, count] : fused.dropped) found.dropped[reason] += count;
  }
  const bool lacking = found.fused && lackDepth(*found.fused);
  const bool may_correct = boxes.classified && found.fused;
  if (frame.stereo && T_map_robot && (lacking || may_correct)) {
    const auto& context = *boxes.context;
    const detect::StereoLifter lifter(camera_, context.disparity(), context.ground());
    if (may_correct) correctTrucks(*camera_, lifter, *found.fused);
    if (lacking) {
      liftBoxes(may_correct && found.motion.tested, *camera_, lifter, *found.fused);
    }
  }
  if (may_correct || by_shape) setTested(may_correct, *found.fused);
  found.elapsed_ms = boxes.elapsed_ms + millisecondsSince(start);
  return found;
}

}  // namespace headway::pipeline
