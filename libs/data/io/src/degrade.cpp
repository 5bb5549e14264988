// SPDX-License-Identifier: BSD-3-Clause
// Noise, misses and duplicates of boxes, to test trackers.
#include <headway/io/degrade.h>

#include <algorithm>

namespace headway::io {

void DegradeParams::describe(Params::Section section) {
  section.add("seed", seed, 0, 2147483647, "", "Seed of the random numbers");
  section.add("min_score", min_score, -1e9, 1e9, "", "Boxes at or below this score are removed");
  section.add("position_sigma_m", position_sigma_m, 0.0, 100.0, "m",
              "Noise of the position along the viewing ray, up to depth_scale_m away");
  section.add("depth_scale_m", depth_scale_m, 0.1, 1e6, "m",
              "Depth beyond which the noise grows in proportion to it");
  section.add("across_ratio", across_ratio, 0.0, 10.0, "",
              "Ratio of the noise across the ray to that along it");
  section.add("drop_probability", drop_probability, 0.0, 1.0, "",
              "Probability that a box is removed");
  section.add("duplicate_probability", duplicate_probability, 0.0, 1.0, "",
              "Probability that a remaining box is duplicated");
  section.add("duplicate_sigma_m", duplicate_sigma_m, 0.0, 100.0, "m",
              "Standard deviation of the duplicate's offset, in each direction");
  section.add("flip_probability", flip_probability, 0.0, 1.0, "",
              "Probability that a box's heading is turned by 180 degrees");
}

Degrader::Degrader(const DegradeParams& params)
    : params_(validated(params)), random_(static_cast<std::uint64_t>(params.seed)) {}

Detections Degrader::degrade(const Detections& detections) {
  Detections result = detections;
  result.items.clear();
  for (Detection detection : detections.items) {
    if (!(detection.score > params_.min_score)) continue;
    if (random_.chance(params_.drop_probability)) continue;
    if (detection.box3d) detection.box3d = degraded(*detection.box3d);
    result.items.push_back(detection);
    if (!random_.chance(params_.duplicate_probability)) continue;
    if (detection.box3d) {
      detection.box3d->centre.x() += params_.duplicate_sigma_m * random_.normal();
      detection.box3d->centre.z() += params_.duplicate_sigma_m * random_.normal();
    }
    detection.detector_id.reset();
    result.items.push_back(detection);
  }
  return result;
}

/// Heights are not changed, since trackers are evaluated on the ground plane (x, z).
Box3d Degrader::degraded(const Box3d& box) {
  DetectorNoise noise;
  noise.along_sigma_m = params_.position_sigma_m;
  noise.across_sigma_m = params_.across_ratio * params_.position_sigma_m;
  noise.flip_probability = params_.flip_probability;
  const double growth = std::max(1.0, box.centre.z() / params_.depth_scale_m);
  Box3d result = measuredBox(box, withCentreScaled(noise, growth), random_);
  result.centre.y() = box.centre.y();
  return result;
}

}  // namespace headway::io
