// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/detector_noise.h>
#include <headway/core/random.h>
#include <headway/sim/sim_params.h>

#include <map>
#include <vector>

#include "visibility.h"

namespace headway::sim {

/// A detection network's output for one image, made from the truth.
///
/// Noise grows with depth, misses with depth and occlusion; some objects are detected twice, some
/// boxes have no object, some headings are turned by 180 degrees, some ids change.
class SimulatedDetector {
 public:
  SimulatedDetector(const DetectorParams& params, const StereoCamera& camera, std::uint64_t seed);

  /// @param depth  of the left picture; false boxes stand where it has surfaces [m]
  [[nodiscard]] Detections detect(Time time, const std::vector<Actor>& actors,
                                  const std::vector<Observation>& observations,
                                  const cv::Mat& depth);

 private:
  [[nodiscard]] bool isMissed(const Actor& actor, const Observation& observation);
  [[nodiscard]] Detection measure(const Actor& actor, const Observation& observation);
  [[nodiscard]] DetectorNoise noiseAt(double depth_m) const;
  [[nodiscard]] Detection falseAlarm(const cv::Mat& depth);
  void finish(Detection& detection) const;

  DetectorParams params_;
  StereoCamera camera_;
  Random random_;
  std::map<std::int64_t, std::int64_t> detector_ids_;  ///< by truth id
  std::int64_t next_id_ = 1;
};

}  // namespace headway::sim
