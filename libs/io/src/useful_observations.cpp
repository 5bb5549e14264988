#include "useful_observations.h"

#include <headway/core/error.h>

#include <algorithm>

#include "observation_kind.h"
#include "observation_stream.h"
#include "recorded_labels.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;

// Kept until the camera is known.
constexpr std::size_t kMostImages = 16;
constexpr std::size_t kMostMotions = 2000;

}  // namespace

CameraChoice UsefulObservations::findCamera() {
  CameraProbe probe(options_.sensor_label);
  while (!probe.isDecided()) {
    const auto observation = read();
    if (!observation) break;
    probe.add(*observation);
    keep(observation);
  }
  try {
    return probe.choose(skipped_);
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
    } else if (isOfUse(*observation)) {
      return observation;
    } else {
      ++skipped_[shortClassName(*observation)];
    }
  }
  return nullptr;
}

bool UsefulObservations::isOfUse(const CObservation& observation) const {
  return isImage(observation) || isRecordedPose(observation) || isRecordedDetections(observation) ||
         (options_.use_imu && isKind<mrpt::obs::CObservationIMU>(observation)) ||
         (options_.use_odometry && isKind<mrpt::obs::CObservationOdometry>(observation));
}

/// Bounds the memory where it takes long until the camera is known.
void UsefulObservations::keep(const CObservation::Ptr& observation) {
  kept_.push_back(observation);
  if (isImage(*observation)) keepLast(kMostImages, isImage);
  if (isMotion(*observation)) keepLast(kMostMotions, isMotion);
}

/// Leaves the first of a kind out where there are more than `most`.
void UsefulObservations::keepLast(std::size_t most, bool (*of_kind)(const CObservation&)) {
  const auto matches = [&](const auto& observation) { return of_kind(*observation); };
  if (static_cast<std::size_t>(std::count_if(kept_.begin(), kept_.end(), matches)) <= most) return;
  const auto first = std::find_if(kept_.begin(), kept_.end(), matches);
  ++skipped_[shortClassName(**first)];
  kept_.erase(first);
}

}  // namespace headway::io
