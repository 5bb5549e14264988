#include "recorded_labels.h"

#include <headway/io/detection_observation.h>
#include <mrpt/obs/CObservationRobotPose.h>

namespace headway::io {

bool isRecordedPose(const mrpt::obs::CObservation& observation) {
  return observation.sensorLabel == kPoseLabel &&
         dynamic_cast<const mrpt::obs::CObservationRobotPose*>(&observation) != nullptr;
}

bool isRecordedDetections(const mrpt::obs::CObservation& observation) {
  return observation.sensorLabel == kDetectionsLabel &&
         dynamic_cast<const CObservationObjectDetections*>(&observation) != nullptr;
}

}  // namespace headway::io
