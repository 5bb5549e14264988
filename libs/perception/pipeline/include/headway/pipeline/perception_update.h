// SPDX-License-Identifier: BSD-3-Clause
// The result of one frame, and findings about the input.
#pragma once

#include <headway/objects/moving_object_tracker.h>
#include <headway/slam/stereo_slam.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

namespace headway::pipeline {

/// What a finding means for the results.
enum class Severity {
  kWarning,  ///< they are degraded
  kFatal,    ///< they are not to be trusted, from this frame to the end: camera or calibration are
             ///< not as described
};

/// Something that is wrong with the input, found in one frame.
struct Finding {
  std::string name;       ///< as listed at Perception::process()
  std::size_t frame = 0;  ///< index
  std::string text;       ///< what is wrong and what to do, one line
  Severity severity = Severity::kWarning;
  bool is_first = false;  ///< the first one of its name
};

using Findings = std::vector<Finding>;

/// Result of one frame: the pose of the robot, the tracks, and what is wrong with the input.
struct PerceptionUpdate {
  std::size_t frame = 0;
  Time time = 0.0;                       ///< [s]
  slam::SlamUpdate camera;               ///< status, T_map_robot and its covariance
  std::optional<Detections> detections;  ///< of all sources; nullopt: no detector ran
  objects::TrackUpdate objects;          ///< in the map; with the dropped detections by reason
  std::vector<Track> tracks_odom;        ///< the tracks in the odometry frame
  Findings findings;                     ///< of this frame

  /// The first finding after which results are not to be trusted; null if this frame has none.
  [[nodiscard]] const Finding* fatalFinding() const {
    const auto found = std::find_if(findings.begin(), findings.end(), [](const Finding& finding) {
      return finding.severity == Severity::kFatal;
    });
    return found == findings.end() ? nullptr : &*found;
  }
};

}  // namespace headway::pipeline
