// SPDX-License-Identifier: BSD-3-Clause
// From observations to frames: images are paired, and boxes, poses and scans assigned to them by
// time.
#include "frame_collector.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/gnss_fix.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <utility>

#include "observation_selection.h"
#include "observation_stream.h"
#include "rectifier.h"

namespace headway::io {
namespace {

constexpr double kMaxDifference = 1.0;   // latencies are shorter [s]
constexpr int kMinImages = 10;           // until a difference is reported
constexpr std::size_t kMaxSensors = 64;  // labels of broken recordings may be arbitrary

std::string textOf(const std::string& sensor, double difference) {
  char amount[64];
  std::snprintf(amount, sizeof amount, "%.3f s %s", std::abs(difference),
                difference > 0.0 ? "after" : "before");
  return "the times of sensor '" + sensor + "' are " + amount +
         " those of the images that arrive with them, so that it cannot be used; synchronise the "
         "clocks of its computer and of the camera's, or let both drivers use the time of arrival";
}

/// The label without other characters than ASCII's, for terminals and JSON.
std::string asciiOf(std::string label) {
  for (char& c : label) {
    if (c < ' ' || c > '~') c = '?';
  }
  return label;
}

constexpr std::size_t kMaxWaiting = 4;  // unpaired images of one side

RecordedPair pairOf(const mrpt::obs::CObservationStereoImages& stereo) {
  RecordedPair pair;
  pair.time = timeFrom(stereo.timestamp);
  pair.left = stereo.imageLeft;
  pair.right = stereo.imageRight;
  pair.left_camera = stereo.leftCamera;
  pair.right_camera = stereo.rightCamera;
  pair.T_robot_left = fromMrpt(stereo.cameraPose);
  pair.T_left_right = fromMrpt(stereo.rightCameraPose);
  return pair;
}

RecordedPair pairOf(const mrpt::obs::CObservationImage& left,
                    const mrpt::obs::CObservationImage& right) {
  RecordedPair pair;
  pair.time = timeFrom(left.timestamp);
  pair.left = left.image;
  pair.right = right.image;
  pair.left_camera = left.cameraParams;
  pair.right_camera = right.cameraParams;
  pair.T_robot_left = fromMrpt(left.cameraPose);
  pair.T_left_right = pair.T_robot_left.inverse() * fromMrpt(right.cameraPose);
  return pair;
}

/// The intensity image as the left one of a pair.
RecordedPair pairOf(const mrpt::obs::CObservation3DRangeScan& scan) {
  RecordedPair pair;
  pair.time = timeFrom(scan.timestamp);
  pair.left = scan.intensityImage;
  pair.left_camera = pair.right_camera = scan.cameraParamsIntensity;
  pair.depth = depthOf(scan);
  pair.T_robot_left = pair.depth->camera.T_robot_color;
  const double focal_px = scan.cameraParamsIntensity.fx();
  pair.T_left_right.translation().x() = equivalentBaseline(focal_px > 0.0 ? focal_px : 1.0);
  return pair;
}

constexpr const char* kUnmatchedLaser = "laser_between_frames";
constexpr double kMaxItemLead = 1.0;              // of an item before its frame [s]
constexpr int kSetBackFrames = 3;                 // that confirm that a clock was set back
constexpr double kHalfIntervalOfOneFrame = 0.05;  // without a second frame [s]

using mrpt::obs::CObservation;

constexpr double kMaxSpeed =
    100.0;  // of a robot between two recorded poses, and a second more [m/s]
constexpr double kMaxInertialValue = 1e4;  // [m/s^2, rad/s]
constexpr double kMaxLaserRangeM = 1e4;    // of any laser
constexpr std::size_t kMaxFixes = 100000;  // between two frames
constexpr const char* kUntakenFixes = "gnss_between_frames";

/// The inertial sample transformed to the robot frame, without what is missing or not finite.
InertialSample sampleFrom(const mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  const Pose T_robot_sensor = fromMrpt(imu.sensorPose);
  if (!isRigid(T_robot_sensor, kMaxSensorOffset_m)) return {timeFrom(imu.timestamp), {}, {}};
  const Eigen::Matrix3d R_robot_sensor = T_robot_sensor.linear();
  const auto vector = [&](TIMUDataIndex x, TIMUDataIndex y,
                          TIMUDataIndex z) -> std::optional<Eigen::Vector3d> {
    if (!imu.has(x) || !imu.has(y) || !imu.has(z)) return std::nullopt;
    const Eigen::Vector3d value(imu.get(x), imu.get(y), imu.get(z));
    if (!(value.cwiseAbs().maxCoeff() <= kMaxInertialValue)) return std::nullopt;
    return Eigen::Vector3d(R_robot_sensor * value);
  };
  return {timeFrom(imu.timestamp), vector(IMU_WX, IMU_WY, IMU_WZ),
          vector(IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC)};
}

/// Ends of the beams with a valid range, in the laser's frame.
std::vector<Eigen::Vector2f> beamEnds(const mrpt::obs::CObservation2DRangeScan& scan) {
  std::vector<Eigen::Vector2f> ends;
  const std::size_t count = scan.getScanSize();
  if (!std::isfinite(scan.aperture) || count < 2) return ends;
  const float step = scan.aperture / static_cast<float>(count - 1);
  for (std::size_t i = 0; i < count; ++i) {
    const float range = scan.getScanRange(i);
    // A range at the limit is recorded by some drivers where nothing was met.
    if (!scan.getScanRangeValidity(i) || !(range > 0.0F) || !(range < scan.maxRange) ||
        range > kMaxLaserRangeM) {
      continue;
    }
    const float from_right = static_cast<float>(i) * step - 0.5F * scan.aperture;
    const float angle = scan.rightToLeft ? from_right : -from_right;
    ends.emplace_back(range * std::cos(angle), range * std::sin(angle));
  }
  return ends;
}

}  // namespace

void ClockCheck::addSample(const std::string& label, Time time) {
  const std::string sensor = asciiOf(label);
  if (sensors_.size() < kMaxSensors || sensors_.count(sensor) > 0) sensors_[sensor].newest = time;
}

void ClockCheck::addImage(std::size_t frame, Time time, Warnings& warnings) {
  for (auto& [name, sensor] : sensors_) {
    if (!sensor.newest) continue;
    const double difference = *sensor.newest - time;
    sensor.images = std::abs(difference) > kMaxDifference ? sensor.images + 1 : 0;
    if (sensor.images >= kMinImages) {
      addWarning("clocks_differ_" + name, frame, textOf(name, difference), warnings);
    }
    sensor.newest.reset();
  }
}

RawStereoCamera rawCameraOf(const RecordedPair& pair) {
  RawStereoCamera raw;
  raw.left = rawCamera(pair.left_camera);
  raw.right = rawCamera(pair.right_camera);
  raw.T_robot_left = pair.T_robot_left;
  raw.T_left_right = pair.T_left_right;
  return raw;
}

bool hasFiniteCalibration(const RecordedPair& pair) {
  for (const auto* camera : {&pair.left_camera, &pair.right_camera}) {
    const bool is_finite = std::isfinite(camera->fx()) && std::isfinite(camera->fy()) &&
                           std::isfinite(camera->cx()) && std::isfinite(camera->cy()) &&
                           std::all_of(camera->dist.begin(), camera->dist.end(),
                                       [](double k) { return std::isfinite(k); });
    if (!is_finite) return false;
  }
  return pair.T_robot_left.matrix().allFinite() && pair.T_left_right.matrix().allFinite();
}

bool StereoPairing::accepts(const mrpt::obs::CObservation& observation) const {
  const auto& label = observation.sensorLabel;
  switch (choice_.kind) {
    case CameraChoice::Kind::kStereo:
      return label == choice_.labels[0] &&
             dynamic_cast<const mrpt::obs::CObservationStereoImages*>(&observation) != nullptr;
    case CameraChoice::Kind::kPair:
      return (label == choice_.labels[0] || label == choice_.labels[1]) &&
             dynamic_cast<const mrpt::obs::CObservationImage*>(&observation) != nullptr;
    case CameraChoice::Kind::kDepth:
      return label == choice_.labels[0] &&
             dynamic_cast<const mrpt::obs::CObservation3DRangeScan*>(&observation) != nullptr;
    case CameraChoice::Kind::kNone:
      break;
  }
  return false;
}

std::optional<RecordedPair> StereoPairing::add(const mrpt::obs::CObservation::Ptr& observation) {
  if (choice_.kind == CameraChoice::Kind::kPair) {
    return addSingle(std::dynamic_pointer_cast<mrpt::obs::CObservationImage>(observation));
  }
  if (choice_.kind == CameraChoice::Kind::kDepth) {
    return addDepth(dynamic_cast<const mrpt::obs::CObservation3DRangeScan&>(*observation));
  }
  const auto stereo = std::dynamic_pointer_cast<mrpt::obs::CObservationStereoImages>(observation);
  if (hasRightImage(*stereo)) return pairOf(*stereo);
  ++skipped_["no_right_image"];
  return std::nullopt;
}

std::optional<RecordedPair> StereoPairing::addDepth(
    const mrpt::obs::CObservation3DRangeScan& scan) {
  if (scan.hasIntensityImage && scan.hasRangeImage) return pairOf(scan);
  ++skipped_[scan.hasIntensityImage ? "no_depth" : "no_intensity_image"];
  return std::nullopt;
}

std::optional<RecordedPair> StereoPairing::addSingle(const Image& image) {
  const std::size_t side = image->sensorLabel == choice_.labels[0] ? 0 : 1;
  auto& partners = waiting_[1 - side];
  const auto distance = [&image](const Image& other) {
    return std::abs(timeFrom(other->timestamp) - timeFrom(image->timestamp));
  };
  const auto nearest =
      std::min_element(partners.begin(), partners.end(),
                       [&](const Image& a, const Image& b) { return distance(a) < distance(b); });
  if (nearest == partners.end() || distance(*nearest) > tolerance_s_) {
    if (nearest != partners.end()) nearest_ = std::min(nearest_, distance(*nearest));
    auto& own = waiting_[side];
    own.push_back(image);
    if (own.size() > kMaxWaiting) {
      own.pop_front();
      countUnpaired(1);
    }
    return std::nullopt;
  }
  const Image partner = *nearest;
  countUnpaired(static_cast<std::size_t>(nearest - partners.begin()) + waiting_[side].size());
  partners.erase(partners.begin(), nearest + 1);
  waiting_[side].clear();  // older than this image, as are their counterparts
  return side == 0 ? pairOf(*image, *partner) : pairOf(*partner, *image);
}

void StereoPairing::finish() {
  for (auto& side : waiting_) {
    countUnpaired(side.size());
    side.clear();
  }
}

void StereoPairing::countUnpaired(std::size_t images) {
  if (images > 0) skipped_["unpaired_image"] += images;
}

bool FrameAssembler::addFrame(PendingFrame frame) {
  frame.index = next_index_++;
  if (auto ahead = std::exchange(ahead_, std::nullopt)) {
    if (frame.time > ahead->time) {
      (void)append(std::move(*ahead));
    } else {
      ++skipped_["time_outlier"];
    }
  }
  const bool is_first_ahead =
      frames_.size() == 1 && !last_taken_ && frames_[0].time - frame.time > kMaxTimeGap_s;
  if (is_first_ahead) {
    ++skipped_["time_outlier"];
    frames_.clear();
    last_added_.reset();
  }
  if (last_added_ && frame.time - *last_added_ > kMaxTimeGap_s) {
    ahead_ = std::move(frame);
    return false;
  }
  return append(std::move(frame));
}

bool FrameAssembler::append(PendingFrame frame) {
  const bool is_backward = last_added_ && !(frame.time > *last_added_);
  if (!is_backward) {
    last_backward_.reset();
  } else if (!isSetBack(frame.time)) {
    ++skipped_["time_backwards"];
    return false;
  } else {
    removeItemsAfter(frame.time);
  }
  last_added_ = frame.time;
  frames_.push_back(std::move(frame));
  return is_backward;
}

/// Whether frames with times before the last one continue each other.
bool FrameAssembler::isSetBack(Time time) {
  const bool continues =
      last_backward_ && time > *last_backward_ && time - *last_backward_ < kMaxTimeGap_s;
  backward_frames_ = continues ? backward_frames_ + 1 : 1;
  last_backward_ = time;
  if (backward_frames_ < kSetBackFrames) return false;
  last_backward_.reset();
  return true;
}

/// Removes boxes, poses and scans of the time before a clock was set back to this one.
void FrameAssembler::removeItemsAfter(Time time) {
  const auto remove = [&](auto& items, const char* unmatched) {
    const auto is_later = [&](const auto& item) { return item.time > time + kMaxItemLead; };
    const auto end = std::remove_if(items.begin(), items.end(), is_later);
    if (end != items.end()) skipped_[unmatched] += static_cast<std::size_t>(items.end() - end);
    items.erase(end, items.end());
  };
  remove(detections_, "unmatched_detections");
  remove(poses_, "unmatched_pose");
  for (auto& [label, scans] : laser_scans_) remove(scans, kUnmatchedLaser);
}

std::optional<PendingFrame> FrameAssembler::take() {
  if (frames_.empty()) return std::nullopt;
  PendingFrame frame = std::move(frames_.front());
  frames_.pop_front();
  const double half_interval = halfInterval(frame.time);
  frame.detections = takeNearest(detections_, frame.time, half_interval, "unmatched_detections");
  if (frame.pair) {
    const auto pose = takeNearest(poses_, frame.time, half_interval, "unmatched_pose");
    if (pose) frame.T_map_robot = pose->value;
  }
  for (auto& [label, scans] : laser_scans_) {
    auto scan = takeNearest(scans, frame.time, half_interval, kUnmatchedLaser);
    if (scan) frame.laser_scans.push_back(std::move(*scan));
  }
  last_taken_ = frame.time;
  return frame;
}

std::size_t FrameAssembler::items() const {
  std::size_t count = detections_.size() + poses_.size();
  for (const auto& [label, scans] : laser_scans_) count += scans.size();
  return count;
}

void FrameAssembler::limitItems(std::size_t max_count) {
  const auto limit = [&](auto& items, const char* unmatched) {
    while (items.size() > max_count) {
      items.pop_front();
      ++skipped_[unmatched];
    }
  };
  limit(detections_, "unmatched_detections");
  limit(poses_, "unmatched_pose");
  for (auto& [label, scans] : laser_scans_) limit(scans, kUnmatchedLaser);
}

void FrameAssembler::finish() {
  if (!frames_.empty()) return;
  if (std::exchange(ahead_, std::nullopt)) ++skipped_["time_outlier"];
  if (!detections_.empty()) skipped_["unmatched_detections"] += detections_.size();
  if (!poses_.empty()) skipped_["unmatched_pose"] += poses_.size();
  for (const auto& [label, scans] : laser_scans_) {
    if (!scans.empty()) skipped_[kUnmatchedLaser] += scans.size();
  }
  detections_.clear();
  poses_.clear();
  laser_scans_.clear();
}

/// Half of the shorter interval to the previous and the next frame, so that boxes and poses of lost
/// frames are not assigned across a gap.
double FrameAssembler::halfInterval(Time time) const {
  double interval = std::numeric_limits<double>::infinity();
  const auto include = [&interval](double seconds) {
    if (seconds > 0.0) interval = std::min(interval, seconds);  // else the clock was set back
  };
  if (last_taken_) include(time - *last_taken_);
  if (!frames_.empty()) include(frames_.front().time - time);
  return std::isfinite(interval) ? 0.5 * interval : kHalfIntervalOfOneFrame;
}

/// Removes the nearest item, and all items that are too old for later frames.
template <typename Item>
std::optional<Item> FrameAssembler::takeNearest(std::deque<Item>& items, Time time,
                                                double half_interval, const char* unmatched) {
  std::optional<Item> nearest;
  std::deque<Item> later;
  for (auto& item : items) {
    const double offset = item.time - time;
    if (offset > half_interval) {
      later.push_back(std::move(item));
    } else if (offset >= -half_interval &&
               (!nearest || std::abs(offset) < std::abs(nearest->time - time))) {
      if (nearest) ++skipped_[unmatched];
      nearest = std::move(item);
    } else {
      ++skipped_[unmatched];
    }
  }
  items = std::move(later);
  return nearest;
}

void FrameCollector::add(const CObservation::Ptr& observation, double arrival_s) {
  compareClocks(*observation);
  if (pairing_.accepts(*observation)) {
    if (auto pair = pairing_.add(observation)) addPair(std::move(*pair), arrival_s);
  } else if (isRecordedDetections(*observation)) {
    const auto& recorded = dynamic_cast<const CObservationObjectDetections&>(*observation);
    if (isRigid(fromMrpt(recorded.sensor_pose), kMaxSensorOffset_m)) {
      assembler_.addDetections(detectionsFrom(recorded, skipped_));
    } else {
      ++skipped_["bad_detections_pose"];
    }
  } else if (isRecordedPose(*observation)) {
    const auto& recorded = dynamic_cast<const mrpt::obs::CObservationRobotPose&>(*observation);
    addPose(timeFrom(recorded.timestamp), fromMrpt(recorded.pose.mean), arrival_s);
  } else if (isMotion(*observation) && has_camera_) {
    addMotion(*observation);
  } else if (isLaser(*observation) && has_camera_) {
    addLaser(dynamic_cast<const mrpt::obs::CObservation2DRangeScan&>(*observation));
  } else if (isGnss(*observation)) {
    const auto& recorded = dynamic_cast<const mrpt::obs::CObservationGPS&>(*observation);
    if (const auto fix = fixFrom(recorded, skipped_)) fixes_.push_back(*fix);
    limitFixes(kMaxFixes);
  } else {
    ++skipped_[shortClassName(*observation)];
  }
}

std::vector<GnssFix> FrameCollector::takeFixes(Time until) {
  std::vector<GnssFix> taken;
  const auto is_later = [until](const GnssFix& fix) { return fix.time > until; };
  const auto end = std::stable_partition(fixes_.begin(), fixes_.end(),
                                         [&](const GnssFix& fix) { return !is_later(fix); });
  taken.assign(fixes_.begin(), end);
  fixes_.erase(fixes_.begin(), end);
  return taken;
}

void FrameCollector::limitFixes(std::size_t max_count) {
  while (fixes_.size() > max_count) {
    fixes_.pop_front();
    ++skipped_[kUntakenFixes];
  }
}

void FrameCollector::compareClocks(const CObservation& observation) {
  const Time time = timeFrom(observation.timestamp);
  if (isImage(observation) && observation.sensorLabel == left_label_) {
    clocks_.addImage(assembler_.nextIndex(), time, warnings_);
  } else if (!isImage(observation) || pairing_.accepts(observation)) {
    const auto& label = observation.sensorLabel;
    clocks_.addSample(label.empty() ? shortClassName(observation) : label, time);
  }
}

void FrameCollector::finish() {
  pairing_.finish();
  assembler_.finish();
  if (!fixes_.empty() && assembler_.frames() == 0) {
    skipped_[kUntakenFixes] += fixes_.size();
    fixes_.clear();
  }
}

void FrameCollector::addPair(RecordedPair pair, double arrival_s) {
  PendingFrame frame;
  frame.arrival_s = arrival_s;
  frame.time = pair.time;
  frame.pair = std::move(pair);
  // Samples of the time before do not continue those of a clock that was set back.
  if (assembler_.addFrame(std::move(frame))) prior_ = MotionPriorBuilder();
}

void FrameCollector::addPose(Time time, const Pose& T_map_robot, double arrival_s) {
  if (!isRigid(T_map_robot, kMaxMapCoordinate_m)) {
    ++skipped_["bad_pose"];
  } else if (!isReachable(time, T_map_robot)) {
    ++skipped_["pose_jump"];
  } else if (has_camera_) {
    assembler_.addPose(time, T_map_robot);
  } else {
    PendingFrame frame;
    frame.arrival_s = arrival_s;
    frame.time = time;
    frame.T_map_robot = T_map_robot;
    (void)assembler_.addFrame(std::move(frame));
  }
}

/// Whether the robot can have moved there from the last recorded pose. A second pose there shows
/// that the map has changed.
bool FrameCollector::isReachable(Time time, const Pose& T_map_robot) {
  const auto from = [&](const std::optional<Stamped<Pose>>& pose) {
    if (!pose) return false;
    const double distance = (T_map_robot.translation() - pose->value.translation()).norm();
    return distance < kMaxSpeed * (1.0 + std::abs(time - pose->time));
  };
  const bool is_reachable = !last_pose_ || from(last_pose_) || from(distant_pose_);
  distant_pose_.reset();
  (is_reachable ? last_pose_ : distant_pose_) = Stamped<Pose>{time, T_map_robot};
  return is_reachable;
}

void FrameCollector::addMotion(const CObservation& observation) {
  if (const auto* imu = dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation)) {
    const InertialSample sample = sampleFrom(*imu);
    if (sample.angular_velocity || sample.acceleration) {
      prior_.addInertial(sample);
    } else {
      ++skipped_["bad_imu"];
    }
    return;
  }
  const auto& odometry = dynamic_cast<const mrpt::obs::CObservationOdometry&>(observation);
  const Pose T_odom_robot = fromMrpt(mrpt::poses::CPose3D(odometry.odometry));
  if (isRigid(T_odom_robot, kMaxMapCoordinate_m)) {
    prior_.addOdometry(timeFrom(odometry.timestamp), T_odom_robot);
  } else {
    ++skipped_["bad_odometry"];
  }
}

void FrameCollector::addLaser(const mrpt::obs::CObservation2DRangeScan& observation) {
  LaserScan scan;
  scan.label = observation.sensorLabel;
  scan.time = timeFrom(observation.timestamp);
  scan.T_robot_laser = fromMrpt(observation.sensorPose);
  if (observation.stdError > 0.0F) scan.sigma_m = static_cast<double>(observation.stdError);
  scan.ends = beamEnds(observation);
  if (!isRigid(scan.T_robot_laser, kMaxSensorOffset_m)) {
    ++skipped_["laser_bad_pose"];
  } else if (scan.ends.empty()) {
    ++skipped_["laser_no_ranges"];
  } else {
    assembler_.addLaserScan(std::move(scan));
  }
}

}  // namespace headway::io
