// SPDX-License-Identifier: BSD-3-Clause
// Noise, misses and duplicates of boxes, to test trackers.
#pragma once

#include <headway/core/detector_noise.h>
#include <headway/core/params.h>

namespace headway::io {

/// Noise, misses, duplicates and flips added to boxes, to test trackers. Section [degrade].
struct DegradeParams {
  int seed = 1;                        ///< 0 ...; the same seed gives the same boxes
  double min_score = 0.0;              ///< boxes at or below it are removed
  double position_sigma_m = 0.3;       ///< along the ray, up to depth_scale_m away [m]
  double depth_scale_m = 20.0;         ///< depth from which noise grows in proportion to it [m]
  double across_ratio = 0.5;           ///< noise across the ray over that along it [-]
  double drop_probability = 0.15;      ///< of each box
  double duplicate_probability = 0.1;  ///< of each remaining box
  double duplicate_sigma_m = 0.5;      ///< of the offset between the two, per axis [m]
  double flip_probability = 0.05;      ///< of the heading turned by 180 degrees

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "degrade"); }  ///< @throws InputError
};

/// Adds noise, misses, duplicates and flips to boxes.
///
/// 3D centres are displaced on the ground plane by core's detector noise; 2D boxes do not change,
/// nor do a duplicate's. To be called frame by frame in order: equal seeds and equal input give
/// equal output.
class Degrader {
 public:
  explicit Degrader(const DegradeParams& params);
  [[nodiscard]] Detections degrade(const Detections& detections);

 private:
  [[nodiscard]] Box3d degraded(const Box3d& box);

  DegradeParams params_;
  Random random_;
};

}  // namespace headway::io
