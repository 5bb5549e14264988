#include <headway/core/error.h>
#include <headway/detect/fusion.h>
#include <headway/detect/stereo_lifter.h>
#include <headway/pipeline/detection_stage.h>
#include <headway/pipeline/moving_regions.h>

#include <algorithm>
#include <opencv2/core.hpp>
#include <sstream>

namespace headway::pipeline {
namespace {

constexpr const char* kNone = "none";
constexpr const char* kAuto = "auto";
constexpr const char* kRecorded = "recorded";
constexpr const char* kDefaultDetector = "stereo_motion";

std::vector<std::string> split(const std::string& names) {
  std::vector<std::string> result;
  std::istringstream list(names + "+");
  for (std::string name; std::getline(list, name, '+');) result.push_back(name);
  return result;
}

bool contains(const std::vector<std::string>& names, const std::string& name) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

std::string choices() {
  std::string text = std::string(kNone) + ", " + kAuto + ", " + kRecorded;
  for (const auto& name : detect::detectorNames()) text += ", " + name;
  return text + "; several joined by +";
}

/// The image detectors that `names` ask for.
std::vector<std::string> imageDetectors(const std::string& names) {
  if (names == kNone) return {};
  if (names == kAuto) return {kDefaultDetector};
  auto result = split(names);
  result.erase(std::remove(result.begin(), result.end(), kRecorded), result.end());
  return result;
}

bool lacksDepth(const Detection& detection) { return detection.box2d && !detection.box3d; }

bool lackDepth(const Detections& detections) {
  return std::any_of(detections.items.begin(), detections.items.end(), lacksDepth);
}

void append(MovingRegions more, MovingRegions& all) {
  all.boxes.insert(all.boxes.end(), more.boxes.begin(), more.boxes.end());
  all.unsure.insert(all.unsure.end(), more.unsure.begin(), more.unsure.end());
  if (all.mask.empty()) {
    all.mask = more.mask;
  } else if (!more.mask.empty()) {
    cv::bitwise_or(all.mask, more.mask, all.mask);
  }
}

}  // namespace

void DetectionParams::describe(Params& params) {
  params.section("detect").user().add(
      "detector", detector,
      "Source of detections: auto (stereo_motion unless boxes are recorded), none, recorded, "
      "stereo_motion, dnn, hog, or several joined by +");
  detect.describe(params);
}

void DetectionParams::validate() const {
  detect.validate();
  try {
    checkDetectorNames(detector);
  } catch (const InputError& error) {
    throw InputError(std::string("[detect] detector = ") + error.what());
  }
}

void checkDetectorNames(const std::string& names) {
  if (names == kNone || names == kAuto) return;
  const auto list = split(names);
  for (const auto& name : list) {
    if (name != kRecorded && !contains(detect::detectorNames(), name)) {
      throw InputError("'" + names + "' is none of " + choices());
    }
    if (std::count(list.begin(), list.end(), name) > 1) {
      throw InputError("'" + names + "' names " + name + " twice");
    }
  }
}

bool usesRecordedBoxes(const std::string& names) {
  return names == kAuto || contains(split(names), kRecorded);
}

DetectionStage::DetectionStage(std::shared_ptr<const StereoCamera> camera,
                               const DetectionParams& params)
    : camera_(std::move(camera)),
      use_recorded_(usesRecordedBoxes(params.detector)),
      automatic_(params.detector == kAuto),
      every_nth_frame_(params.detect.every_nth_frame),
      matcher_(std::make_shared<stereo::DisparityMatcher>(params.detect.disparity)) {
  params.validate();
  const auto names = imageDetectors(params.detector);
  if (camera_ == nullptr && !names.empty() && !automatic_) {
    throw InputError("[detect] detector = " + params.detector +
                     ": needs stereo images, and the recording holds none");
  }
  if (camera_ == nullptr) return;
  for (const auto& name : names) {
    detectors_.push_back(detect::makeDetector(name, camera_, params.detect, matcher_));
  }
}

DetectionStage::~DetectionStage() = default;

void DetectionStage::begin(const RecordedFrame& frame, bool scanned) {
  found_.clear();
  if (use_recorded_ && frame.detections) {
    found_.push_back(camera_ != nullptr ? inSensorFrame(*frame.detections, camera_->T_robot_cam)
                                        : *frame.detections);
    if (automatic_) detectors_.clear();
  }
  const bool has_turn = frames_++ % every_nth_frame_ == 0;
  looking_ = has_turn && frame.stereo && !detectors_.empty();
  if (looking_) ask(false, *frame.stereo, std::nullopt);
  lifting_ = frame.stereo && std::any_of(found_.begin(), found_.end(), lackDepth);
  const bool for_detector =
      looking_ && std::any_of(detectors_.begin(), detectors_.end(),
                              [](const auto& detector) { return detector->needsPose(); });
  if (lifting_ || for_detector || scanned) matcher_->begin(*frame.stereo);  // while SLAM is at work
}

void DetectionStage::ask(bool with_pose, const StereoFrame& frame,
                         const std::optional<Pose>& T_map_robot) {
  for (const auto& detector : detectors_) {
    if (detector->needsPose() != with_pose) continue;
    if (auto detections = detector->detect(frame, T_map_robot)) {
      found_.push_back(std::move(*detections));
    }
  }
}

MovingRegions DetectionStage::movingRegions(const RecordedFrame& frame,
                                            const std::vector<Track>& previous) const {
  MovingRegions regions;
  if (camera_ == nullptr) return regions;
  for (const auto& detections : found_) {
    append(pipeline::movingRegions(detections, previous, *camera_), regions);
  }
  for (const auto& detector : detectors_) append(detector->movingRegions(frame.time), regions);
  return regions;
}

std::optional<Detections> DetectionStage::finish(const RecordedFrame& frame,
                                                 const std::optional<Pose>& T_map_robot) {
  if (looking_) ask(true, *frame.stereo, T_map_robot);
  if (found_.empty()) return std::nullopt;
  Detections all = detect::fuse(found_);
  if (frame.stereo && T_map_robot && lackDepth(all)) lift(*frame.stereo, all);
  return all;
}

void DetectionStage::lift(const StereoFrame& frame, Detections& detections) {
  const auto& disparity = matcher_->of(frame);
  ground_ = stereo::findGround(disparity, *camera_, ground_);
  detect::liftAll(detections, detect::StereoLifter(camera_, disparity, ground_));
}

std::optional<GroundScan> DetectionStage::scanGround(const RecordedFrame& frame,
                                                     const Pose& T_map_robot,
                                                     const std::vector<Track>& tracks,
                                                     const detect::GroundScanParams& params) {
  const auto& disparity = matcher_->of(*frame.stereo);
  // Sought again even where finish() sought it to lift boxes: begun from there it gets more exact.
  ground_ = stereo::findGround(disparity, *camera_, ground_);
  if (!ground_) return std::nullopt;
  auto moving = movingRegions(frame, tracks);
  append(pipeline::movingRegions(tracks, T_map_robot, *camera_), moving);
  return detect::scanGround(disparity, *camera_, *ground_, moving, params);
}

DropCounts DetectionStage::takeDropped() {
  DropCounts all;
  for (const auto& detector : detectors_) {
    for (const auto& [reason, count] : detector->dropped()) all[reason] += count;
  }
  DropCounts since;
  for (const auto& [reason, count] : all) {
    const auto before = dropped_before_.find(reason);
    const std::size_t more = count - (before != dropped_before_.end() ? before->second : 0);
    if (more > 0) since[reason] = more;
  }
  dropped_before_ = std::move(all);
  return since;
}

}  // namespace headway::pipeline
