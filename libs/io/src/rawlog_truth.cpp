#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include "observation_stream.h"
#include "recorded_labels.h"

namespace headway::io {

RecordedTruth readTruth(const std::string& path) {
  RecordedTruth truth;
  std::map<std::string, std::size_t> skipped;
  ObservationStream stream(path, skipped);
  while (const auto observation = stream.next()) {
    const auto& label = observation->sensorLabel;
    const auto* pose = dynamic_cast<const mrpt::obs::CObservationRobotPose*>(observation.get());
    const auto* objects = dynamic_cast<const CObservationObjectDetections*>(observation.get());
    if (pose != nullptr && label == kTruthPoseLabel) {
      truth.poses.push_back({timeFrom(pose->timestamp), fromMrpt(pose->pose.mean)});
    } else if (objects != nullptr && label == kTruthObjectsLabel) {
      truth.objects.push_back(detectionsFrom(*objects, skipped));
    }
  }
  return truth;
}

}  // namespace headway::io
