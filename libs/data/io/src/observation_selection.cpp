// SPDX-License-Identifier: BSD-3-Clause
// Which observations of a recording are used: those of the one camera, boxes, poses and sensors of
// motion.
#include "observation_selection.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/detection_observation.h>
#include <headway/io/rawlog_sink.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationRobotPose.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <algorithm>

#include "observation_stream.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;

// Number of poses without any image after which a rawlog is taken to contain only poses.
constexpr std::size_t kPosesWithoutImages = 1000;

template <typename Map>
std::string keysOf(const Map& map) {
  std::string text;
  for (const auto& [key, value] : map) text += (text.empty() ? "'" : ", '") + printable(key) + "'";
  return text;
}

}  // namespace

CameraChoice UsefulObservations::findCamera() {
  (void)readForCamera();
  return chooseCamera();
}

bool UsefulObservations::readForCamera() {
  while (!probe_.isDecided()) {
    const auto observation = read();
    if (!observation) return false;
    probe_.add(*observation);
    keep(observation);
  }
  return true;
}

CameraChoice UsefulObservations::chooseCamera() const {
  try {
    return probe_.choose(skipped_);
  } catch (const InputError& error) {
    if (!truncation()) throw;
    throw InputError(error.what() + ("; " + *truncation()));
  }
}

CObservation::Ptr UsefulObservations::next() {
  if (kept_.empty()) return read();
  auto observation = kept_.front();
  kept_.pop_front();
  return observation;
}

CObservation::Ptr UsefulObservations::read() {
  while (auto observation = reader_->next()) {
    if (isTruth(observation->sensorLabel)) {
      ++skipped_["truth"];
    } else if (isTimesAssumed(*observation)) {
      addWarning(kTimesAssumed, 0, kTimesAssumedText, warnings_);
    } else if (observation->timestamp == INVALID_TIMESTAMP) {
      ++skipped_["no_time"];
    } else if (isUseful(*observation)) {
      return observation;
    } else {
      ++skipped_[shortClassName(*observation)];
    }
  }
  return nullptr;
}

bool UsefulObservations::isUseful(const CObservation& observation) const {
  return isImage(observation) || isRecordedPose(observation) || isRecordedDetections(observation) ||
         isGnss(observation) || (options_.use_laser && isLaser(observation)) ||
         (options_.use_imu && isKind<mrpt::obs::CObservationIMU>(observation)) ||
         (options_.use_odometry && isKind<mrpt::obs::CObservationOdometry>(observation));
}

/// Stores an observation with bounded memory.
void UsefulObservations::keep(const CObservation::Ptr& observation) {
  kept_.push_back(observation);
  if (isImage(*observation)) keepLast(limits_.images, isImage);
  if (isMotion(*observation)) keepLast(limits_.motions, isMotion);
  if (isLaser(*observation)) keepLast(limits_.laser_scans, isLaser);
  if (isGnss(*observation)) keepLast(limits_.gnss, isGnss);
}

/// Drops the first observation of a kind if there are more than `max_count`.
void UsefulObservations::keepLast(std::size_t max_count, bool (*of_kind)(const CObservation&)) {
  const auto matches = [&](const auto& observation) { return of_kind(*observation); };
  if (static_cast<std::size_t>(std::count_if(kept_.begin(), kept_.end(), matches)) <= max_count)
    return;
  const auto first = std::find_if(kept_.begin(), kept_.end(), matches);
  ++skipped_[shortClassName(**first)];
  kept_.erase(first);
}

bool isTimesAssumed(const CObservation& observation) {
  return observation.sensorLabel == kTimesAssumed &&
         isKind<mrpt::obs::CObservationComment>(observation);
}

bool isRecordedPose(const mrpt::obs::CObservation& observation) {
  return observation.sensorLabel == kPoseLabel &&
         dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&observation) != nullptr;
}

bool isRecordedDetections(const mrpt::obs::CObservation& observation) {
  return observation.sensorLabel == kDetectionsLabel &&
         dynamic_cast<const CObservationObjectDetections*>(&observation) != nullptr;
}

void CameraProbe::add(const mrpt::obs::CObservation& observation) {
  if (const auto* stereo = dynamic_cast<const mrpt::obs::CObservationStereoImages*>(&observation)) {
    if (hasRightImage(*stereo)) ++stereo_[observation.sensorLabel];
  } else if (dynamic_cast<const mrpt::obs::CObservationImage*>(&observation) != nullptr) {
    auto& camera = single_[observation.sensorLabel];
    ++camera.count;
    observation.getSensorPose(camera.pose);
  } else if (const auto* scan =
                 dynamic_cast<const mrpt::obs::CObservation3DRangeScan*>(&observation)) {
    if (scan->hasIntensityImage && scan->hasRangeImage) ++depth_[observation.sensorLabel];
  } else if (isRecordedPose(observation)) {
    ++poses_;
  }
}

bool CameraProbe::isDecided() const {
  if (!wanted_.empty()) return wantedCamera().has_value();
  for (const auto& [label, count] : stereo_) {
    if (count >= 2) return true;  // a second camera would have occurred by now
  }
  if (stereo_.empty() && single_.size() >= 2) {
    bool all_twice = true;
    for (const auto& [label, camera] : single_) all_twice = all_twice && camera.count >= 2;
    return all_twice;
  }
  for (const auto& [label, count] : depth_) {
    if (count >= 2) return true;
  }
  return stereo_.empty() && single_.empty() && depth_.empty() && poses_ >= kPosesWithoutImages;
}

std::optional<CameraChoice> CameraProbe::wantedCamera() const {
  if (stereo_.count(wanted_) > 0) {
    return CameraChoice{CameraChoice::Kind::kStereo, {wanted_, ""}};
  }
  if (depth_.count(wanted_) > 0) return CameraChoice{CameraChoice::Kind::kDepth, {wanted_, ""}};
  const auto comma = wanted_.find(',');
  if (comma == std::string::npos) return std::nullopt;
  const std::string left = wanted_.substr(0, comma);
  const std::string right = wanted_.substr(comma + 1);
  if (single_.count(left) == 0 || single_.count(right) == 0) return std::nullopt;
  return CameraChoice{CameraChoice::Kind::kPair, {left, right}};
}

CameraChoice CameraProbe::choose(const std::map<std::string, std::size_t>& skipped) const {
  if (!wanted_.empty()) {
    const auto choice = wantedCamera();
    if (choice) return *choice;
    throw InputError("contains no stereo camera with label '" + wanted_ +
                     "' (two cameras are selected as 'LEFT,RIGHT'); it contains " +
                     labelsSeen(skipped));
  }
  if (stereo_.size() > 1) {
    throw InputError("contains several stereo cameras; select one by its sensor label: " +
                     keysOf(stereo_));
  }
  if (stereo_.size() == 1) {
    return {CameraChoice::Kind::kStereo, {stereo_.begin()->first, ""}};
  }
  if (single_.size() == 2) return pairByGeometry();
  if (single_.size() > 2) {
    throw InputError(
        "contains several cameras; select two by their sensor labels as 'LEFT,RIGHT': " +
        keysOf(single_));
  }
  if (depth_.size() > 1) {
    throw InputError("contains several depth cameras; select one by its sensor label: " +
                     keysOf(depth_));
  }
  if (depth_.size() == 1) return {CameraChoice::Kind::kDepth, {depth_.begin()->first, ""}};
  if (poses_ > 0) return {};
  const auto timeless = skipped.find("no_time");
  if (timeless != skipped.end() && stereo_.empty() && single_.empty()) {
    throw InputError(std::to_string(timeless->second) +
                     " observations have no timestamp, and none that has one is of a stereo camera "
                     "or a pose: the driver or converter must set the times of capture");
  }
  throw InputError(
      "contains neither stereo images nor poses labelled 'pose' nor images with depth; it "
      "contains " +
      labelsSeen(skipped) +
      (single_.empty() ? ""
                       : ": a stereo camera gives images of two labels, or both in one image "
                         "(side_by_side), a depth camera images with depth"));
}

/// The left camera is the one with the other to its right.
CameraChoice CameraProbe::pairByGeometry() const {
  const auto& [label_a, camera_a] = *single_.begin();
  const auto& [label_b, camera_b] = *single_.rbegin();
  const auto b_in_a = camera_b.pose - camera_a.pose;
  CameraChoice choice{CameraChoice::Kind::kPair, {label_a, label_b}};
  if (b_in_a.x() < 0.0) std::swap(choice.labels[0], choice.labels[1]);
  return choice;
}

std::string CameraProbe::labelsSeen(const std::map<std::string, std::size_t>& skipped) const {
  std::string text;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (!stereo_.empty()) add("stereo " + keysOf(stereo_));
  if (!depth_.empty()) add("depth " + keysOf(depth_));
  if (!single_.empty()) add("single images " + keysOf(single_));
  if (!skipped.empty()) add("other observations: " + keysOf(skipped));
  if (poses_ > 0) add("poses");
  return text.empty() ? "no usable observations" : text;
}

}  // namespace headway::io
