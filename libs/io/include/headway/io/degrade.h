#pragma once

#include <headway/core/detector_noise.h>
#include <headway/core/params.h>

namespace headway::io {

/// Noise, misses, duplicates and flips that are added to boxes, to test filters.
struct DegradeParams {
  int seed = 1;                     ///< 0 ...; the same seed gives the same boxes
  double min_score = 0.0;           ///< boxes at or below it are left out
  double position_sigma_m = 0.3;    ///< [m] along the ray, up to depth_scale_m away
  double depth_scale_m = 20.0;      ///< [m] beyond it the noise grows with the depth
  double across_share = 0.5;        ///< noise across the ray, as a ratio of that along it
  double drop_probability = 0.15;   ///< of each box
  double double_probability = 0.1;  ///< of each box that is left
  double double_sigma_m = 0.5;      ///< [m] between the two
  double flip_probability = 0.05;   ///< of the heading turned by 180 degrees

  void describe(Params::Section section);
  void validate() const { validateRanges(*this, "degrade"); }  ///< @throws InputError
};

/// Adds noise, misses, doubles and flips to boxes.
///
/// 3D centres move by core's detector noise, but stay at their height; 2D boxes stay where they
/// are (a duplicate's too). Call it frame by frame in order: equal seeds and equal input give equal
/// output.
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
