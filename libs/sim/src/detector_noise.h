#pragma once

#include <headway/sim/sim_params.h>

#include <map>
#include <vector>

#include "random.h"
#include "visibility.h"

namespace headway::sim {

/// Turns truth into what a detection network makes of an image.
///
/// Noise grows with depth, misses with depth and occlusion; now and then an object is found
/// twice, a box has no object, a heading is turned round, an id changes.
/// @see Hu et al. 2022, "Monocular quasi-dense 3D object tracking" (QD-3DT), the kind of detector
///      that is emulated
class DetectorNoise {
 public:
  DetectorNoise(const DetectorParams& params, const StereoCamera& camera, std::uint64_t seed);

  /// @param depth  of the left picture; false boxes stand where it has surfaces [m]
  [[nodiscard]] Detections detect(Time time, const std::vector<Mover>& movers,
                                  const std::vector<Sighting>& sightings, const cv::Mat& depth);

 private:
  [[nodiscard]] bool isMissed(const Mover& mover, const Sighting& sighting);
  [[nodiscard]] Detection measure(const Mover& mover, const Sighting& sighting);
  [[nodiscard]] Detection imagine(const cv::Mat& depth);
  void finish(Detection& detection) const;

  DetectorParams params_;
  StereoCamera camera_;
  Random random_;
  std::map<std::int64_t, std::int64_t> detector_ids_;  ///< by truth id
  std::int64_t next_id_ = 1;
};

}  // namespace headway::sim
