#pragma once

#include <mrpt/obs/CObservation.h>

#include <string>

namespace headway::io {

inline constexpr char kDetectionsLabel[] = "detections";       ///< boxes to be used
inline constexpr char kPoseLabel[] = "pose";                   ///< poses to be used
inline constexpr char kTruthPoseLabel[] = "truth_pose";        ///< for evaluation alone
inline constexpr char kTruthObjectsLabel[] = "truth_objects";  ///< for evaluation alone

/// Whether the label says that estimators must not see the observation.
[[nodiscard]] inline bool isTruth(const std::string& label) {
  return label.rfind("truth_", 0) == 0;
}

/// Whether it is a robot pose that is to be used instead of visual SLAM.
[[nodiscard]] bool isRecordedPose(const mrpt::obs::CObservation& observation);

/// Whether it holds boxes that are to be used.
[[nodiscard]] bool isRecordedDetections(const mrpt::obs::CObservation& observation);

}  // namespace headway::io
