// SPDX-License-Identifier: BSD-3-Clause
#include "useful_observations.h"

#include <headway/core/error.h>
#include <headway/io/detection_observation.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>

#include "observation_stream.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;

// Maximum numbers of observations stored until the camera is determined.
constexpr std::size_t kMaxImages = 16;
constexpr std::size_t kMaxMotions = 2000;
constexpr std::size_t kMaxLaserScans = 50;
constexpr std::size_t kMaxGnss = 1000;

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
  if (isImage(*observation)) keepLast(kMaxImages, isImage);
  if (isMotion(*observation)) keepLast(kMaxMotions, isMotion);
  if (isLaser(*observation)) keepLast(kMaxLaserScans, isLaser);
  if (isGnss(*observation)) keepLast(kMaxGnss, isGnss);
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

bool isRecordedPose(const mrpt::obs::CObservation& observation) {
  return observation.sensorLabel == kPoseLabel &&
         dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&observation) != nullptr;
}

bool isRecordedDetections(const mrpt::obs::CObservation& observation) {
  return observation.sensorLabel == kDetectionsLabel &&
         dynamic_cast<const CObservationObjectDetections*>(&observation) != nullptr;
}

}  // namespace headway::io
